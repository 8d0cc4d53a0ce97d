/** How much is drawn: `full` with soft shadows and smooth edges, `light` for tablets and machines without much of a GPU. */
export type Quality = 'full' | 'light';

/** Waiting this long for a picture on average, where a screen refresh takes 17 ms, is being slow. */
const SLOW_MS = 40;
const GAIN = 0.05;
const FIRST_LOOK = 30;

/** The quality that the page's address asks for (`?drawing=full`, `?drawing=light`), which is then kept; null if it asks for none. */
export function wishedQuality(address: string): Quality | null {
  const wish = new URL(address).searchParams.get('drawing');
  return wish === 'full' || wish === 'light' ? wish : null;
}

/** Whether a canvas can be drawn on at all. */
export function canDraw(): boolean {
  return hasContext({});
}

/** Whether a canvas would be drawn without the help of a GPU. */
export function hasSoftwareOnly(): boolean {
  return !hasContext({ failIfMajorPerformanceCaveat: true });
}

function hasContext(attributes: WebGLContextAttributes): boolean {
  const context = document.createElement('canvas').getContext('webgl2', attributes);
  context?.getExtension('WEBGL_lose_context')?.loseContext(); // a browser has few contexts to give
  return context !== null;
}

/** Watches how long pictures are waited for, and says once when they are too slow. */
export class PaceWatch {
  private meanMs = 0;
  private pictures = 0;

  /** A picture was begun `waitedMs` after it was asked for; true if drawing should become light now. */
  tooSlow(waitedMs: number): boolean {
    // A page in the background waits for minutes; that says nothing about drawing.
    if (waitedMs > 1000) return false;
    this.meanMs += GAIN * (waitedMs - this.meanMs);
    this.pictures += 1;
    return this.pictures > FIRST_LOOK && this.meanMs > SLOW_MS;
  }
}
