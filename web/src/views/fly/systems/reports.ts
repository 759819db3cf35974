/** Reports of the systems of a vehicle beside its autopilot, as rows of names and values for people. */

import { MavArmAuthDeniedReason, MavCmd, MavCollisionThreatLevel, MavResult } from '$generated';
import { enumName, enumValues, officialName } from '$lib/decoder/Decoder';
import { t, type TextKey } from '$lib/i18n';
import { format, UNKNOWN } from '$lib/units/units';

export type Fields = Readonly<Record<string, unknown>>;

/** One line of a report. */
export interface Row {
  readonly name: string;
  readonly value: string;
  readonly isBad?: boolean;
}

/** Counts of a stream whose single messages say nothing to people. */
export interface Counts {
  /** Messages a second. */
  readonly rate: number;
  /** Messages that the sequence numbers show as lost. */
  readonly lost: number;
}

type Reader = (fields: Fields, counts: Counts) => readonly Row[];

/** A kind of report. */
export interface Kind {
  readonly title: TextKey;
  /** Field that tells several devices of the kind apart; empty: there is one. */
  readonly instance: string;
  readonly read: Reader;
}

const NO_U8 = 0xff;
const NO_U16 = 0xffff;
const NO_I16 = 0x7fff;
const ESCS_PER_MESSAGE = 4;
/** UAVIONIX_ADSB_OUT_STATUS_STATE_1090ES_TX_ENABLED and those of replies in modes A, C and S. */
const TRANSMITS = 128;
const IDENTIFIES = 8;
const HEALTHY_TRANSCEIVER = 1;

/** Returns a number in a unit; null: not known. */
function known(value: unknown, unknown: number | null = null, scale = 1): number | null {
  const plain = Number(value);
  return Number.isFinite(plain) && plain !== unknown ? plain * scale : null;
}

const rpm = (value: number | null): string =>
  value === null ? UNKNOWN : t('payload.rpm', { value: Math.round(value) });

/** Returns a row; null if nothing is known for it. */
function row(name: string, value: string, isBad = false): Row[] {
  return value.split(', ').every((part) => part === UNKNOWN) ? [] : [{ name, value, isBad }];
}

const joined = (...parts: string[]): string => parts.filter((part) => part !== UNKNOWN).join(', ') || UNKNOWN;

/** Returns the names of the set flags of an enum; those that are left out are not shown. */
export function flagsOf(name: string, value: unknown, hidden: readonly string[] = []): string[] {
  const bits = BigInt(Number(value ?? 0));
  return Object.entries(enumValues(name) ?? {})
    .filter(([flag, bit]) => bit !== 0 && (bits & BigInt(bit)) !== 0n && !hidden.includes(flag))
    .map(([flag]) => officialName(flag));
}

function escRow(number: number, parts: readonly string[], isBad: boolean): Row[] {
  return row(t('payload.motorNumber', { number }), joined(...parts), isBad);
}

/** ESC_TELEMETRY_1_TO_4 and its followers: the first number of the message is in its name. */
export function escTelemetry(first: number): Reader {
  return (fields) => {
    const values = (name: string): readonly number[] => Array.from((fields[name] ?? []) as ArrayLike<number>);
    return values('rpm').flatMap((speed, index) =>
      // A controller that was never heard has counted nothing.
      values('count')[index] === 0
        ? []
        : escRow(
            first + index,
            [
              rpm(speed),
              format(values('voltage')[index]! / 100, 'voltage'),
              format(values('current')[index]! / 100, 'current'),
              format(values('temperature')[index]!, 'temperature'),
            ],
            false,
          ),
    );
  };
}

/** Returns a row for each motor controller of ESC_STATUS. */
function escStatus(fields: Fields): Row[] {
  const first = Number(fields.index ?? 0) + 1;
  const values = (name: string): readonly number[] => (fields[name] ?? []) as readonly number[];
  return values('rpm')
    .slice(0, ESCS_PER_MESSAGE)
    .flatMap((speed, index) =>
      escRow(
        first + index,
        [
          rpm(speed),
          format(known(values('voltage')[index]), 'voltage'),
          format(known(values('current')[index]), 'current'),
        ],
        false,
      ),
    );
}

/** Returns a row for each motor controller of ESC_INFO that exists: temperature and failures. */
function escInfo(fields: Fields): Row[] {
  const first = Number(fields.index ?? 0);
  const count = Math.min(Math.max(Number(fields.count ?? 0) - first, 0), ESCS_PER_MESSAGE);
  return Array.from({ length: count }, (_, index) => {
    const temperature = known((fields.temperature as readonly number[])[index], NO_I16, 0.01);
    const failures = flagsOf('ESC_FAILURE_FLAGS', (fields.failure_flags as readonly number[])[index]);
    const isOnline = ((Number(fields.info) >> index) & 1) === 1;
    return escRow(
      first + index + 1,
      [format(temperature, 'temperature'), isOnline ? UNKNOWN : t('payload.offline'), failures.join(' ') || UNKNOWN],
      !isOnline || failures.length > 0,
    );
  }).flat();
}

/** States of a generator that are not faults. */
const GENERATOR_STATES = ['OFF', 'READY', 'GENERATING', 'CHARGING', 'MAXPOWER', 'WARMING_UP', 'IDLE', 'REDUCED_POWER'];

function generator(fields: Fields): Row[] {
  const faults = flagsOf('MAV_GENERATOR_STATUS_FLAG', fields.status, GENERATOR_STATES);
  const power = known(fields.power_generated);
  return [
    ...row(t('payload.state'), flagsOf('MAV_GENERATOR_STATUS_FLAG', fields.status).join(' '), faults.length > 0),
    ...row(t('payload.speed'), rpm(known(fields.generator_speed, NO_U16))),
    ...row(
      t('payload.power'),
      joined(
        power === null ? UNKNOWN : t('payload.watts', { value: Math.round(power) }),
        format(known(fields.bus_voltage), 'voltage'),
        format(known(fields.load_current), 'current'),
      ),
    ),
    ...row(t('payload.temperature'), format(known(fields.generator_temperature, NO_I16), 'temperature')),
  ];
}

function engine(fields: Fields): Row[] {
  const flow = known(fields.fuel_flow);
  const used = known(fields.fuel_consumed);
  return [
    ...row(t('payload.speed'), rpm(known(fields.rpm)), Number(fields.health) === 0),
    ...row(t('payload.load'), format(known(fields.engine_load, null, 0.01), 'percent')),
    ...row(
      t('payload.fuel'),
      joined(
        flow === null ? UNKNOWN : t('payload.flow', { value: flow.toFixed(1) }),
        used === null ? UNKNOWN : t('payload.fuelUsed', { value: Math.round(used) }),
      ),
    ),
    ...row(t('payload.temperature'), format(known(fields.cylinder_head_temperature), 'temperature')),
  ];
}

function modem(fields: Fields): Row[] {
  const quality = known(fields.quality, NO_U8, 0.01);
  const reason = Number(fields.failure_reason ?? 0);
  return [
    ...row(
      t('payload.state'),
      joined(
        enumName('CELLULAR_STATUS_FLAG', Number(fields.status)) ?? UNKNOWN,
        enumName('CELLULAR_NETWORK_RADIO_TYPE', Number(fields.type)) ?? UNKNOWN,
        reason === 0 ? UNKNOWN : (enumName('CELLULAR_NETWORK_FAILED_REASON', reason) ?? UNKNOWN),
      ),
      reason !== 0,
    ),
    ...row(t('payload.quality'), format(quality, 'percent')),
  ];
}

function highLatency(fields: Fields): Row[] {
  const failures = flagsOf('HL_FAILURE_FLAG', fields.failure_flags);
  return [
    { name: t('payload.failures'), value: failures.join(' ') || t('payload.none'), isBad: failures.length > 0 },
    ...row(t('payload.battery'), format(known(fields.battery, -1, 0.01), 'percent')),
    ...row(t('payload.toTarget'), format(known(fields.target_distance, null, 10), 'distance', 0)),
  ];
}

function transponder(fields: Fields): Row[] {
  const state = Number(fields.state ?? 0);
  const faults = flagsOf('UAVIONIX_ADSB_OUT_STATUS_FAULT', fields.fault);
  return [
    { name: t('payload.squawk'), value: String(Number(fields.squawk ?? 0)).padStart(4, '0') },
    ...row(t('payload.flightId'), String(fields.flight_id ?? '').trim() || UNKNOWN),
    {
      name: t('payload.state'),
      value: joined(
        t((state & TRANSMITS) !== 0 ? 'payload.transmits' : 'payload.standby'),
        (state & IDENTIFIES) !== 0 ? t('payload.ident') : UNKNOWN,
        faults.join(' ') || UNKNOWN,
      ),
      isBad: faults.length > 0,
    },
  ];
}

/** An aircraft that the autopilot regards as a threat. */
function collision(fields: Fields): Row[] {
  const threat = Number(fields.threat_level ?? 0);
  const action = enumName('MAV_COLLISION_ACTION', Number(fields.action ?? 0)) ?? UNKNOWN;
  const distances = joined(
    format(known(fields.horizontal_minimum_delta), 'distance', 0),
    format(known(fields.altitude_minimum_delta), 'distance', 0),
  );
  return [
    {
      name: t('payload.threat'),
      value: enumName('MAV_COLLISION_THREAT_LEVEL', threat) ?? UNKNOWN,
      isBad: threat !== MavCollisionThreatLevel.NONE,
    },
    ...row(t('payload.closest'), joined(distances, formatSeconds(known(fields.time_to_minimum_delta)))),
    { name: t('payload.evasion'), value: action },
  ];
}

const formatSeconds = (seconds: number | null): string =>
  seconds === null ? UNKNOWN : t('payload.inSeconds', { value: Math.round(seconds) });

function transceiver(fields: Fields): Row[] {
  const isHealthy = Number(fields.rfHealth) === HEALTHY_TRANSCEIVER;
  const health = flagsOf('UAVIONIX_ADSB_RF_HEALTH', fields.rfHealth).join(' ');
  return [{ name: t('payload.state'), value: health || UNKNOWN, isBad: !isHealthy }];
}

function frames(_: Fields, { rate }: Counts): Row[] {
  return [{ name: t('payload.frames'), value: t('payload.perSecond', { value: rate.toFixed(0) }) }];
}

function logBlocks(_: Fields, { rate, lost }: Counts): Row[] {
  return [
    { name: t('payload.blocks'), value: t('payload.perSecond', { value: rate.toFixed(0) }) },
    { name: t('payload.lost'), value: String(lost), isBad: lost > 0 },
  ];
}

/** The answer of the autopilot to a command that injects a failure. */
function failure(fields: Fields): Row[] {
  const isInjected = Number(fields.result) === MavResult.ACCEPTED;
  const name = enumName('MAV_RESULT', Number(fields.result)) ?? UNKNOWN;
  return [{ name: t('payload.lastCommand'), value: isInjected ? t('payload.injected') : name, isBad: isInjected }];
}

/** The answer of the system that the vehicle asks whether it may arm. */
function authorization(fields: Fields): Row[] {
  if (Number(fields.result) === MavResult.ACCEPTED) {
    return [{ name: t('payload.answer'), value: t('payload.mayArm', { seconds: Number(fields.result_param2 ?? 0) }) }];
  }
  const reason = enumName('MAV_ARM_AUTH_DENIED_REASON', Number(fields.progress ?? 0));
  const item =
    Number(fields.progress) === MavArmAuthDeniedReason.INVALID_WAYPOINT ? ` ${Number(fields.result_param2)}` : '';
  return [
    { name: t('payload.answer'), value: t('payload.mayNotArm', { reason: `${reason ?? ''}${item}` }), isBad: true },
  ];
}

const MAX_ESCS = 32;
const ESCS = Array.from({ length: MAX_ESCS / ESCS_PER_MESSAGE }, (_, group) => {
  const first = group * ESCS_PER_MESSAGE + 1;
  const name = `ESC_TELEMETRY_${first}_TO_${first + ESCS_PER_MESSAGE - 1}`;
  return [name, { title: 'payload.motors', instance: '', read: escTelemetry(first) }] as const;
});

/** Kinds of reports by the name of their message. */
export const KINDS: Readonly<Record<string, Kind>> = {
  ...Object.fromEntries(ESCS),
  ESC_STATUS: { title: 'payload.motors', instance: 'index', read: escStatus },
  ESC_INFO: { title: 'payload.motorControllers', instance: 'index', read: escInfo },
  GENERATOR_STATUS: { title: 'payload.generator', instance: '', read: generator },
  EFI_STATUS: { title: 'payload.engine', instance: 'ecu_index', read: engine },
  CELLULAR_STATUS: { title: 'payload.modem', instance: 'id', read: modem },
  HIGH_LATENCY2: { title: 'payload.highLatency', instance: '', read: highLatency },
  UAVIONIX_ADSB_OUT_STATUS: { title: 'payload.transponder', instance: '', read: transponder },
  UAVIONIX_ADSB_TRANSCEIVER_HEALTH_REPORT: { title: 'payload.transceiver', instance: '', read: transceiver },
  COLLISION: { title: 'payload.collision', instance: 'id', read: collision },
  CAN_FRAME: { title: 'payload.canBus', instance: 'bus', read: frames },
  CANFD_FRAME: { title: 'payload.canFdBus', instance: 'bus', read: frames },
  LOGGING_DATA: { title: 'payload.logStream', instance: '', read: logBlocks },
  LOGGING_DATA_ACKED: { title: 'payload.logStream', instance: '', read: logBlocks },
};

/** Kinds of reports by the command that is answered. */
export const ANSWERS: Readonly<Record<number, Kind>> = {
  [MavCmd.INJECT_FAILURE]: { title: 'payload.failureInjection', instance: '', read: failure },
  [MavCmd.ARM_AUTHORIZATION_REQUEST]: { title: 'payload.armAuthorizer', instance: '', read: authorization },
};
