/** The tables of MSP messages, generated from those of `mavstack.msp`. */

import generated from '../../generated/msp.json';

export type Variant = 'BTFL' | 'INAV';

export type NumberType = 'u8' | 'i8' | 'u16' | 'i16' | 'u32' | 'i32';

export interface NumberFacts {
  readonly kind: NumberType;
  /** The value is `(offset + raw * step) / perUnit`. */
  readonly perUnit?: number;
  readonly step?: number;
  readonly offset?: number;
  readonly isBool?: boolean;
  /** Names of values, or of bits. */
  readonly values?: Readonly<Record<string, string>>;
  readonly bits?: Readonly<Record<string, string>>;
}

export type CodecFacts =
  | NumberFacts
  | { readonly kind: 'variant'; readonly BTFL: CodecFacts; readonly INAV: CodecFacts }
  | { readonly kind: 'record'; readonly fields: readonly FieldFacts[] }
  | {
      readonly kind: 'items';
      readonly item: CodecFacts;
      readonly count?: number;
      readonly counted?: boolean;
      readonly leave?: number;
      readonly countField?: string;
    }
  | { readonly kind: 'text' | 'prefixed'; readonly length: number; readonly fill: string }
  | { readonly kind: 'bytes'; readonly length: number | null }
  | { readonly kind: 'rest' | 'names' | 'counted' };

export interface FieldFacts {
  readonly name: string;
  readonly codec: CodecFacts;
  /** It may be missing at the end of a payload. */
  readonly optional: boolean;
  readonly unit?: string;
  /** The version of Betaflight's interface that added it. */
  readonly since?: string;
  readonly variant?: string;
  readonly default?: number;
}

export interface MessageFacts {
  readonly command: number;
  /** The official name, such as `MSP_ATTITUDE`. */
  readonly name: string;
  readonly isReply: boolean;
  readonly variants: readonly string[];
  readonly fields: readonly FieldFacts[];
}

interface Facts {
  readonly messages: Readonly<Record<string, MessageFacts>>;
  /** Names of modes by their permanent numbers. */
  readonly modes: Readonly<Record<Variant, Readonly<Record<string, string>>>>;
  readonly pids: Readonly<Record<Variant, readonly string[]>>;
  readonly osdItems: readonly string[];
  readonly baudRates: Readonly<Record<Variant, readonly number[]>>;
  /** Names of serial ports by identifier. */
  readonly portNames: Readonly<Record<string, string>>;
  /** Names of Betaflight's reasons not to arm by bit. */
  readonly armingReasons: Readonly<Record<string, string>>;
}

export const FACTS = generated as unknown as Facts;

/** The identity of a flight controller, on which layouts depend. */
export interface Firmware {
  readonly variant: Variant;
  /** The version of the MSP interface: major, minor. */
  readonly api: readonly [number, number];
}

/** Returns the facts of a message by its class, such as `StatusEx`. */
export function messageFacts(name: string): MessageFacts {
  const facts = FACTS.messages[name];
  if (facts === undefined) throw new Error(`MSP has no message ${name}`);
  return facts;
}
