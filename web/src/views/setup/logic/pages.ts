/** The sections of the set-up, and those in which the items of the check list are mended. */

export type Section =
  | 'first'
  | 'airframe'
  | 'parameters'
  | 'calibration'
  | 'modes'
  | 'receiver'
  | 'battery'
  | 'failsafes'
  | 'actuators'
  | 'ports'
  | 'tuning'
  | 'estimator'
  | 'video'
  | 'payload'
  | 'firmware'
  | 'shell';

/** The names of the items are those of `mavstack.vehicle.setup.first_flight`. */
const SECTIONS: Readonly<Record<string, Section>> = {
  airframe: 'airframe',
  accelerometer: 'calibration',
  gyroscope: 'calibration',
  compass: 'calibration',
  receiver: 'receiver',
  battery: 'battery',
  charge: 'battery',
  'loss of the radio': 'failsafes',
  'loss of the ground station': 'failsafes',
  'low battery': 'failsafes',
  geofence: 'failsafes',
  settings: 'parameters',
};

/** Returns the section in which an item of the check list is mended, or null. */
export function sectionOf(item: string): Section | null {
  return SECTIONS[item] ?? null;
}
