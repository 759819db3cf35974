/** The files .px4 and .apj: JSON with the image, compressed by zlib and encoded by base64, and its board. */

import { FlashingError } from './errors';

export interface FirmwareFile {
  readonly kind: 'px4' | 'apj';
  /** Bytes for the internal flash, in whole words. */
  readonly image: Uint8Array;
  /** Bytes for the external flash; empty if it has none. */
  readonly external: Uint8Array;
  readonly boardId: number;
  /** Size of the largest image for the board, by the file; null if it names none. */
  readonly maxSize: number | null;
  /** The image has a signature, which the bootloader verifies. */
  readonly isSigned: boolean;
  readonly name: string;
  readonly version: string;
}

const KINDS: Readonly<Record<string, FirmwareFile['kind']>> = { PX4FWv1: 'px4', PX4FWv2: 'px4', APJFWv1: 'apj' };
/** Maximum size of a file, and of an image that is unpacked, in bytes. */
export const MAX_SIZE = 64_000_000;

type Fields = Readonly<Record<string, unknown>>;

/** Parses a file; throws with the reason if it is too large, damaged, or names no board. */
export async function parseFirmware(file: Blob, name: string): Promise<FirmwareFile> {
  if (file.size > MAX_SIZE) throw damaged(name, `more than ${MAX_SIZE / 1_000_000} MB, no firmware is that large`);
  const data = new Uint8Array(await file.arrayBuffer());
  const fields = fieldsOf(data, name);
  const kind = KINDS[String(fields.magic)];
  if (kind === undefined) throw damaged(name, 'it is neither a .px4 nor an .apj file');
  const { board_id: boardId, image_maxsize: maxSize } = fields;
  if (!isNumber(boardId) || boardId <= 0 || boardId > 0xffff_ffff)
    throw damaged(name, 'the file does not name its board (board_id)');
  const image = await imageOf(fields, 'image', 'image_size', name);
  if (image.length === 0) throw damaged(name, 'the file has no image');
  return {
    kind,
    image,
    external: await imageOf(fields, 'extf_image', 'extf_image_size', name),
    boardId,
    maxSize: isNumber(maxSize) && maxSize > 0 ? maxSize : null,
    isSigned: Boolean(fields.image_signed) || Boolean(fields.signed_firmware),
    name: text(fields.summary) || text(fields.description),
    version: text(fields.version) || text(fields.git_identity) || text(fields.git_hash),
  };
}

function fieldsOf(data: Uint8Array, name: string): Fields {
  try {
    const fields: unknown = JSON.parse(new TextDecoder().decode(data));
    if (typeof fields === 'object' && fields !== null && !Array.isArray(fields)) return fields as Fields;
  } catch {
    throw damaged(name, 'not JSON, the file may be cut off');
  }
  throw damaged(name, 'not an object of JSON');
}

async function imageOf(fields: Fields, key: string, sizeKey: string, name: string): Promise<Uint8Array> {
  const packed = fields[key];
  if (packed === undefined || packed === null) return new Uint8Array();
  let image: Uint8Array;
  try {
    image = await unpacked(Uint8Array.from(atob(String(packed)), (each) => each.charCodeAt(0)));
  } catch {
    throw damaged(name, `${key} is damaged`);
  }
  const size = fields[sizeKey];
  if (size !== undefined && size !== null && size !== image.length)
    throw damaged(name, `${key} has ${image.length} bytes, and ${sizeKey} says ${String(size)}`);
  const whole = new Uint8Array(Math.ceil(image.length / 4) * 4).fill(0xff);
  whole.set(image);
  return whole;
}

async function unpacked(data: Uint8Array<ArrayBuffer>): Promise<Uint8Array> {
  const reader = new Blob([data]).stream().pipeThrough(new DecompressionStream('deflate')).getReader();
  const parts: Uint8Array[] = [];
  let size = 0;
  for (;;) {
    const { value, done } = await reader.read();
    if (done) break;
    size += value.length;
    if (size > MAX_SIZE) throw new Error('too large');
    parts.push(value);
  }
  const whole = new Uint8Array(size);
  let at = 0;
  for (const part of parts) {
    whole.set(part, at);
    at += part.length;
  }
  return whole;
}

const isNumber = (value: unknown): value is number => typeof value === 'number' && Number.isInteger(value);
const text = (value: unknown): string => (typeof value === 'string' ? value : '');
const damaged = (name: string, reason: string): FlashingError => new FlashingError(`reading ${name} failed: ${reason}`);
