/** A decoder as its form holds it: its declaration as text, and bytes to try it with. */
import { type FrameDecoder, FrameReader, readDecoder } from '$lib/frames/decoder';
import { fromHex, isHex } from '$lib/frames/members';
import { t } from '$lib/i18n';
import type { NamedDecoder } from '$lib/sources/stationSources';

export interface DecoderDraft {
  text: string;
  bytes: string;
}

export interface ReadDecoder {
  readonly decoder: FrameDecoder | null;
  readonly problem: string | null;
}

/** A new decoder, with bytes that it reads. */
export const EXAMPLE: DecoderDraft = {
  text: JSON.stringify(
    {
      name: 'bench',
      framing: { kind: 'length', marker: 'aa55', length: { offset: 2, type: 'uint8' }, add: 5 },
      checksum: { kind: 'crc16-ccitt', start: 2 },
      id: { offset: 3, type: 'uint8' },
      messages: [
        {
          name: 'IMU',
          id: 1,
          fields: [
            { name: 'roll', type: 'int16', factor: 0.01, unit: 'deg' },
            { name: 'mode', type: 'uint8', names: { '0': 'IDLE', '1': 'FLYING' } },
          ],
        },
      ],
    },
    null,
    2,
  ),
  bytes: 'aa 55 04 01 06 ff 01 c0 4f',
};

export function draftOf({ declaration }: NamedDecoder): DecoderDraft {
  return { text: JSON.stringify(declaration, null, 2), bytes: '' };
}

/** Returns the decoder of a form, or what is wrong with it. */
export function readDraft({ text }: DecoderDraft): ReadDecoder {
  try {
    return { decoder: readDecoder(text), problem: null };
  } catch (error) {
    return { decoder: null, problem: (error as Error).message };
  }
}

/** Returns the decoder of a form that has no problem. */
export function userDecoder({ text }: DecoderDraft): NamedDecoder {
  const declaration = JSON.parse(text) as Record<string, unknown>;
  return { name: readDecoder(text).name, declaration };
}

/** Returns the rows of the bytes of a form, as lines. */
export function tryDraft({ bytes }: DecoderDraft, decoder: FrameDecoder): string[] {
  if (bytes.trim() === '') return [];
  if (!isHex(bytes)) return [t('dashboards.tryWrong')];
  const reader = new FrameReader(decoder);
  const rows = reader.feed(fromHex(bytes));
  const lines = rows.map(({ message, fields }) => `${message} ${JSON.stringify(fields)}`);
  if (reader.refused > 0) lines.push(t('dashboards.tryRefused', { count: reader.refused }));
  return lines.length > 0 ? lines : [t('dashboards.tryNothing')];
}
