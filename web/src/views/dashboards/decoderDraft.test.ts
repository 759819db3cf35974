import { expect, it } from 'vitest';
import { draftOf, EXAMPLE, readDraft, tryDraft, userDecoder } from './decoderDraft';

it('the example reads its bytes', () => {
  const { decoder, problem } = readDraft(EXAMPLE);
  expect(problem).toBeNull();
  expect(tryDraft(EXAMPLE, decoder!)).toEqual(['IMU {"roll":-2.5,"mode":"FLYING"}']);
  expect(draftOf(userDecoder(EXAMPLE)).text).toBe(EXAMPLE.text);
});

it('says what is wrong', () => {
  expect(readDraft({ text: '{"framing": {}}', bytes: '' }).problem).toContain('framing.kind must be one of');
  const { decoder } = readDraft(EXAMPLE);
  const tried = (bytes: string): string[] => tryDraft({ ...EXAMPLE, bytes }, decoder!);
  expect(tried('')).toEqual([]);
  expect(tried('aa5')).toEqual(['These are not hexadecimal digits such as aa 55.']);
  expect(tried('aa 55')).toEqual(['No frame is complete.']);
  expect(tried('aa 55 04 01 06 ff 01 00 00')).toEqual(['1 frame refused']);
});
