/** Channels of a radio control: all in RC_CHANNELS, or eight of each port in RC_CHANNELS_RAW. */

import type { DecodedMessage } from '$lib/decoder/Decoder';

import type { VehicleState } from './Vehicle';

type Radio = NonNullable<VehicleState['rc']>;
type Fields = DecodedMessage['fields'];

const NO_U16 = 0xffff;
const NO_U8 = 0xff;
const MAX_RSSI = 254;
const PORT_CHANNELS = 8;
const MAX_PORTS = 4;

/** Returns the radio control of RC_CHANNELS. */
export function radioOf(fields: Fields): Radio {
  return { channels: pulses(fields, Number(fields.chancount)), rssi: rssiOf(fields) };
}

/** Returns a radio control with the channels of a port of RC_CHANNELS_RAW. */
export function withPort(before: Radio | null, fields: Fields): Radio | null {
  const port = Number(fields.port ?? 0);
  if (port >= MAX_PORTS) return before;
  const first = port * PORT_CHANNELS;
  const [own, others] = [pulses(fields, PORT_CHANNELS), before?.channels ?? []];
  const channels = Array.from({ length: Math.max(others.length, first + PORT_CHANNELS) }, (_, index) => {
    const isOwn = index >= first && index < first + PORT_CHANNELS;
    return isOwn ? own[index - first]! : (others[index] ?? null);
  });
  const rssi = rssiOf(fields);
  return { channels, rssi: port === 0 ? rssi : (before?.rssi ?? rssi) };
}

/** Returns the pulses of the first channels; 0, which ArduPilot sends without a receiver, is not a pulse. */
function pulses(fields: Fields, count: number): (number | null)[] {
  return Array.from({ length: count }, (_, index) => {
    const pulse = Number(fields[`chan${index + 1}_raw`] ?? 0);
    return pulse === 0 || pulse === NO_U16 ? null : pulse;
  });
}

function rssiOf(fields: Fields): number | null {
  const rssi = Number(fields.rssi);
  return rssi === NO_U8 ? null : rssi / MAX_RSSI;
}
