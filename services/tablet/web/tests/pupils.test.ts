import { describe, expect, it } from 'vitest';
import { PATIENCE_MS, TOLD_MS, Wish } from '../src/state/wish.svelte';

describe('a wish', () => {
  const wished = (...values: (string | null)[]): Wish => {
    const wish = new Wish();
    wish.confirm('7');
    for (const value of values) wish.ask(value, 0);
    return wish;
  };

  it('is shown as one until the box has confirmed it', () => {
    const wish = wished('8');
    wish.confirm('7'); // a status that was under way
    expect([wish.state, wish.shown('7')]).toEqual(['pending', '8']);
    wish.confirm('8');
    expect([wish.state, wish.shown('9')]).toEqual(['settled', '9']);
    wish.elapse(60_000);
    expect(wish.state).toBe('settled');
  });

  it('gives way to what another tablet asked for since', () => {
    const wish = wished('8');
    wish.confirm('9');
    expect([wish.state, wish.shown('9')]).toEqual(['settled', '9']);
  });

  it('waits for the last of several touches, of which the box does the first one first', () => {
    const wish = wished('8', '9');
    wish.confirm('8');
    expect([wish.state, wish.shown('8')]).toEqual(['pending', '9']);
    wish.confirm('9');
    expect(wish.state).toBe('settled');
  });

  it('that the box does not do in time is taken back, and that is said for a while', () => {
    const wish = wished(null);
    wish.elapse(PATIENCE_MS);
    expect([wish.state, wish.shown('7')]).toEqual(['pending', null]);
    wish.elapse(PATIENCE_MS + 1);
    wish.confirm('7');
    expect([wish.state, wish.shown('7'), wish.value]).toEqual(['overdue', '7', null]);
    wish.elapse(PATIENCE_MS + TOLD_MS);
    expect(wish.state).toBe('overdue');
    wish.elapse(PATIENCE_MS + TOLD_MS + 2);
    expect(wish.state).toBe('settled');
  });

  it('that the box does late is done', () => {
    const wish = wished('8');
    wish.elapse(PATIENCE_MS + 1);
    wish.confirm('8');
    expect(wish.state).toBe('settled');
  });

  it.each([
    ['8', 'settled'],
    ['7', 'overdue'],
  ])('that the connection was lost over is %s after it: %s', (ofBox, state) => {
    const wish = wished('8');
    wish.reconnect();
    wish.confirm(ofBox);
    wish.elapse(60_000);
    expect([wish.state, wish.shown(ofBox)]).toEqual([state, ofBox]);
  });

  it('can be wished again after it was overdue', () => {
    const wish = wished('8');
    wish.elapse(60_000);
    wish.ask('8', 60_000);
    expect(wish.state).toBe('pending');
    wish.confirm('8');
    expect(wish.state).toBe('settled');
  });
});
