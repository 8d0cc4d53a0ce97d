import { afterEach, beforeEach, expect, it, vi } from 'vitest';
import { Link } from '../src/connection/link';

/** A socket as the browser makes one; the test says what the server does. */
class FakeSocket {
  static readonly OPEN = 1;
  static made: FakeSocket[] = [];
  readyState = 0;
  binaryType = '';
  closes = 0;
  onopen: (() => void) | null = null;
  onclose: ((event: { code: number }) => void) | null = null;

  constructor() {
    FakeSocket.made.push(this);
  }

  accept(): void {
    this.readyState = FakeSocket.OPEN;
    this.onopen?.();
  }

  send(): void {
    // Nobody listens.
  }

  close(): void {
    this.closes += 1;
  }
}

let link: Link;

beforeEach(() => {
  vi.useFakeTimers();
  vi.stubGlobal('WebSocket', FakeSocket);
  FakeSocket.made = [];
  link = new Link('ws://box/ws', { motion: vi.fn(), status: vi.fn(), attempts: vi.fn(), changed: vi.fn() });
  link.start();
});

afterEach(() => {
  link.stop();
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

it('a server that takes the call and never answers it is called again within seconds', () => {
  vi.advanceTimersByTime(8000);
  expect(FakeSocket.made.map(({ closes }) => closes)).toEqual([1, 0]);
  expect(link.failures).toBe(1);
});

it('a server that hangs for minutes is found as soon as it answers', () => {
  vi.advanceTimersByTime(180_000);
  expect(FakeSocket.made.length).toBeGreaterThan(15);
  const tries = FakeSocket.made.length;
  while (FakeSocket.made.length === tries) vi.advanceTimersByTime(100);
  FakeSocket.made.at(-1)?.accept();
  expect(link.connected).toBe(true);
});

it('a server that answers late, but answers, is waited for', () => {
  vi.advanceTimersByTime(4500);
  FakeSocket.made[0]?.accept();
  expect(link.connected).toBe(true);
  expect(FakeSocket.made.length).toBe(1);
});
