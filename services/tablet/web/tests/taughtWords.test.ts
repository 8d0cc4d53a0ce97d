import { afterEach, describe, expect, it, vi } from 'vitest';
import { TaughtWords } from '../src/connection/taughtWords';
import type { Teaching } from '../src/protocol/messages';

const said = (code: string): Teaching => ({ languages: [code], actions: {} });
const answer = (code: string, status = 200) => new Response(JSON.stringify(said(code)), { status });

afterEach(() => vi.unstubAllGlobals());

describe('words of what is taught', () => {
  it('are asked for once, and again when the box has others', async () => {
    const fetched = vi.fn(async () => answer(fetched.mock.calls.length === 1 ? 'en' : 'de'));
    vi.stubGlobal('fetch', fetched);
    const take = vi.fn();
    const words = new TaughtWords(take);
    for (const revision of ['a', 'a', 'b', 'b']) await words.hear(revision);
    expect(take.mock.calls).toEqual([[said('en')], [said('de')]]);
    expect(fetched).toHaveBeenCalledTimes(2);
  });

  it('that did not arrive are asked for again while the connection lasts', async () => {
    const fetched = vi
      .fn()
      .mockResolvedValueOnce(answer('en', 503))
      .mockRejectedValueOnce(new TypeError('no network'))
      .mockResolvedValueOnce(new Response('{"half'))
      .mockResolvedValueOnce(answer('en'));
    vi.stubGlobal('fetch', fetched);
    const take = vi.fn();
    const words = new TaughtWords(take);
    for (let time = 0; time < 5; time++) await words.hear('a');
    expect(take.mock.calls).toEqual([[said('en')]]);
    expect(fetched).toHaveBeenCalledTimes(4);
  });

  it('that arrive after newer ones were asked for are not taken', async () => {
    const answers: ((response: Response) => void)[] = [];
    vi.stubGlobal('fetch', () => new Promise<Response>((resolve) => answers.push(resolve)));
    const take = vi.fn();
    const words = new TaughtWords(take);
    const both = [words.hear('a'), words.hear('b')];
    answers[1]!(answer('de'));
    answers[0]!(answer('en'));
    await Promise.all(both);
    expect(take.mock.calls).toEqual([[said('de')]]);
  });

  it('are asked for anew with another connection, also if those before never arrive', async () => {
    const fetched = vi
      .fn()
      .mockReturnValueOnce(new Promise(() => {}))
      .mockResolvedValueOnce(answer('en'));
    vi.stubGlobal('fetch', fetched);
    const take = vi.fn();
    const words = new TaughtWords(take);
    void words.hear('a');
    words.reconnect();
    await words.hear('a');
    expect(take.mock.calls).toEqual([[said('en')]]);
  });
});
