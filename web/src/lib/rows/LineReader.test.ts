import { expect, it } from 'vitest';

import { LineReader } from './LineReader';

const bytes = (text: string): Uint8Array => new TextEncoder().encode(text);

it('collects lines from parts, with characters that a part ends in', () => {
  const reader = new LineReader();
  const text = bytes('1,2\r\n\n3,°\n4');
  const found = [...text].flatMap((byte) => reader.feed(new Uint8Array([byte])));
  expect(found).toEqual(['1,2', '3,°']);
  expect(reader.feed(bytes('\n'))).toEqual(['4']);
  expect(reader.feed(new Uint8Array([255, 10]))).toEqual(['\ufffd']);
});

it('drops lines that are too long, and no others', () => {
  const reader = new LineReader();
  expect(reader.feed(bytes(`${'x'.repeat(4096)}\n${'y'.repeat(9000)}\n5\n`))).toEqual(['x'.repeat(4096), '5']);
  expect(reader.dropped).toBe(1);
});
