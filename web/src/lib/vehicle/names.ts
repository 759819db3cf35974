/** Names of vehicles and severities for people. */

import { MavSeverity } from '$generated';
import { t } from '$lib/i18n';
import type { VehicleState } from '$lib/vehicle/Vehicle';

/** Returns a name such as `Copter 1`. */
export function vehicleName(state: VehicleState): string {
  return t('shell.vehicleName', { type: t(`shell.${state.type}`), system: state.system });
}

/** Severity of a status text, in three steps. */
export function toneOf(severity: number): 'error' | 'warning' | 'info' {
  if (severity <= MavSeverity.ERROR) return 'error';
  return severity === MavSeverity.WARNING ? 'warning' : 'info';
}
