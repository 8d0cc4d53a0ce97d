import { readFileSync } from 'node:fs';
import openapiTS, { astToString } from 'openapi-typescript';
import { expect, it } from 'vitest';
import { readServerMessage } from '../src/protocol/messages';

it('the types of the messages are those of the server', async () => {
  const description = new URL('../openapi.json', import.meta.url);
  const made = astToString(await openapiTS(description));
  const committed = readFileSync(new URL('../src/protocol/openapi.ts', import.meta.url), 'utf-8');
  // The command line tool puts its banner in front.
  expect(committed.endsWith(made), 'run `npm run types`').toBe(true);
}, 30_000);

it('a message of a newer box is left alone', () => {
  expect(readServerMessage('{"type":"weather"}')).toBeNull();
});
