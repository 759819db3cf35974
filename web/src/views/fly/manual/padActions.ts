/** The actions of a gamepad's buttons on the selected vehicle. */

import { t, type TextKey } from '$lib/i18n';
import type { Vehicle } from '$lib/vehicle/Vehicle';

import { actions } from '../actions.svelte';
import type { PadAction } from './pad';

export const PAD_TEXTS: Readonly<Record<PadAction, TextKey>> = {
  hold: 'fly.hold',
  rtl: 'fly.rtl',
  land: 'fly.land',
  mission: 'fly.startMission',
  arm: 'fly.arm',
  disarm: 'fly.disarm',
  photo: 'payload.photo',
  center: 'payload.center',
};

const ACTS: Readonly<Record<PadAction, (vehicle: Vehicle) => Promise<unknown>>> = {
  hold: (vehicle) => vehicle.hold(),
  rtl: (vehicle) => vehicle.rtl(),
  land: (vehicle) => vehicle.land(),
  mission: (vehicle) => vehicle.startMission(),
  arm: (vehicle) => vehicle.arm(),
  disarm: (vehicle) => vehicle.disarm(),
  photo: (vehicle) => vehicle.sendCommand('IMAGE_START_CAPTURE', [0, 0, 1]),
  center: (vehicle) => vehicle.sendCommand('DO_GIMBAL_MANAGER_PITCHYAW', [0, 0, null, null, 0, 0, 0]),
};

/** Lets a vehicle do the action of a button; refusals are shown as those of the other actions are. */
export function actByPad(action: PadAction, vehicle: Vehicle): void {
  void actions.run(t(PAD_TEXTS[action]), [vehicle], ACTS[action]);
}
