import type { Teaching } from '../protocol/messages';

/** The words of what is taught: asked for with every connection, and again when the box says that it has others. */
export class TaughtWords {
  /** Of the words that are here, or under way. */
  private revision: string | null = null;

  /** @param take is given all words whenever they arrive */
  constructor(private readonly take: (teaching: Teaching) => void) {}

  /** The box told which words it has; it does so twice a second. */
  async hear(revision: string): Promise<void> {
    if (revision === this.revision) return;
    this.revision = revision;
    const teaching = await fetchTeaching();
    if (this.revision !== revision) return; // others were asked for by now
    if (teaching === null)
      this.revision = null; // asked again when the box is heard next
    else this.take(teaching);
  }

  /** Another connection: what was under way on the one before may never arrive. */
  reconnect(): void {
    this.revision = null;
  }
}

async function fetchTeaching(): Promise<Teaching | null> {
  try {
    const response = await fetch('/api/teaching');
    return response.ok ? ((await response.json()) as Teaching) : null;
  } catch {
    return null;
  }
}
