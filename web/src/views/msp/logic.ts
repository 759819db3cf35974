/** Facts of flight controllers for the sections of the page. */

import type { MspFields, MspValue } from '$lib/msp/codec';
import { FACTS, messageFacts, type CodecFacts, type FieldFacts, type NumberFacts, type Variant } from '$lib/msp/facts';

const STICKS = ['ROLL', 'PITCH', 'YAW', 'THROTTLE'] as const;

/** Returns the name of a channel of MSP_RC. */
export function channelName(index: number): string {
  return STICKS[index] ?? `AUX ${index - STICKS.length + 1}`;
}

/** Returns the names of the modes that are active: `ids` are those of MSP_BOXIDS, in their order. */
export function activeModes(status: MspFields, ids: readonly number[], variant: Variant): string[] {
  return ids.filter((_, position) => hasBit(status, position)).map((id) => FACTS.modes[variant][id] ?? String(id));
}

function hasBit(status: MspFields, position: number): boolean {
  const words = status.mode_words as readonly number[] | undefined;
  if (words) return ((words[Math.floor(position / 32)] ?? 0) / 2 ** (position % 32)) % 2 >= 1;
  if (position < 32) return (Number(status.mode_flags) / 2 ** position) % 2 >= 1;
  const extra = status.extra_mode_flags as readonly number[] | undefined;
  const [byte, bit] = [Math.floor((position - 32) / 8), (position - 32) % 8];
  return (((extra?.[byte] ?? 0) >> bit) & 1) === 1;
}

/** Returns the names of the bits of a number, such as sensors. */
export function bitNames(message: string, field: string, value: number, first = 0): string[] {
  const facts = messageFacts(message).fields.find((each) => each.name === field)?.codec as NumberFacts | undefined;
  return Object.entries(facts?.bits ?? {})
    .filter(([bit]) => Number(bit) >= 2 ** first && Math.floor(value / Number(bit)) % 2 === 1)
    .map(([, name]) => name);
}

/** The first reason of iNav not to arm; bits before it are states. */
const FIRST_INAV_REASON = 6;

/** Returns the reasons not to arm. */
export function armingReasons(status: MspFields, variant: Variant): string[] {
  if (variant === 'INAV') return bitNames('InavStatus', 'arming_flags', Number(status.arming_flags), FIRST_INAV_REASON);
  const [flags, count] = [Number(status.arming_disable_flags ?? 0), Number(status.arming_disable_flag_count ?? 0)];
  return Array.from({ length: 32 }, (_, bit) => bit)
    .filter((bit) => Math.floor(flags / 2 ** bit) % 2 === 1)
    .map((bit) => (bit === count - 1 ? 'ARM_SWITCH' : (FACTS.armingReasons[bit] ?? `FLAG_${bit}`)));
}

export interface OsdPosition {
  readonly column: number;
  readonly row: number;
  readonly isShown: boolean;
}

const AXIS = 31;
const PROFILE_1 = 1 << 11;
const PROFILES = 7 << 11;
const INAV_VISIBLE = 1 << 13;
const WIDE = 1 << 10;
const INAV_AXIS = 63;

/** Returns where an item of the display is; iNav has other bits than Betaflight. */
export function osdPosition(bits: number, variant: Variant): OsdPosition {
  if (variant === 'INAV') {
    return { column: bits & INAV_AXIS, row: (bits >> 6) & INAV_AXIS, isShown: (bits & INAV_VISIBLE) !== 0 };
  }
  const column = (bits & AXIS) | (bits & WIDE ? 32 : 0);
  return { column, row: (bits >> 5) & AXIS, isShown: (bits & PROFILES) !== 0 };
}

/** Returns the bits of a position; other profiles and forms of an item stay as they are. */
export function osdBits({ column, row, isShown }: OsdPosition, before: number, variant: Variant): number {
  if (variant === 'INAV') return column | (row << 6) | (isShown ? INAV_VISIBLE : 0);
  const kept = before & ~(AXIS | (AXIS << 5) | WIDE | PROFILES);
  const profiles = isShown ? (before & PROFILES) | PROFILE_1 : 0;
  return kept | (column & AXIS) | (column > AXIS ? WIDE : 0) | (row << 5) | profiles;
}

/** Returns the fields of a message that a form can show: numbers and switches. */
export function formFields(message: string, values: MspFields): FieldFacts[] {
  return messageFacts(message).fields.filter(
    ({ name, codec }) =>
      /^[ui]\d+$/.test(codec.kind) && values[name] !== undefined && !name.startsWith('reserved') && !hasBits(codec),
  );
}

const hasBits = (codec: FieldFacts['codec']): boolean => 'bits' in codec && codec.bits !== undefined;

/** Returns the words of a field's name. */
export function fieldLabel({ name, unit }: FieldFacts): string {
  return `${name.replaceAll('_', ' ')}${unit ? ` (${unit})` : ''}`;
}

/** Returns the fields of MSP_SET_VTX_CONFIG for those of MSP_VTX_CONFIG. */
export function vtxRequest(values: MspFields): MspFields {
  const [band, channel] = [Number(values.band ?? 0), Number(values.channel ?? 1)];
  const combined: MspValue = band > 0 ? 8 * (band - 1) + channel - 1 : Number(values.frequency ?? 0);
  return { ...values, combined };
}

/** Returns the functions of a serial port by bit, with their names in a firmware. */
export function functionsOf(codec: CodecFacts, variant: Variant): [number, string][] {
  if (codec.kind === 'variant') return functionsOf(codec[variant], variant);
  if (codec.kind === 'items') return functionsOf(codec.item, variant);
  if (codec.kind === 'record') {
    const field = codec.fields.find(({ name }) => name === 'functions');
    return field === undefined ? [] : functionsOf(field.codec, variant);
  }
  const bits = 'bits' in codec ? codec.bits : {};
  return Object.entries(bits ?? {}).map(([bit, name]) => [Number(bit), name]);
}
