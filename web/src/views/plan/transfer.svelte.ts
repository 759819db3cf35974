/** Plans to and from the vehicle, with progress. */

import { t } from '$lib/i18n';
import type { Plan as VehiclePlan, Vehicle } from '$lib/vehicle/Vehicle';
import { toast, toastError } from '$lib/ui/toasts.svelte';

import { editor, KINDS } from './editor.svelte';
import { apiItems, fromApi } from './formats/mavstack';
import { fenceAreas, fenceItems, rallyItems, rallyPoints } from './logic/fence';
import { isEmpty, withoutKept, type Item, type Plan, type PlanKind } from './logic/model';

class Transfer {
  kind: PlanKind | null = $state(null);
  isUpload = $state(false);
  done = $state(0);
  total: number | null = $state(null);

  get isRunning(): boolean {
    return this.kind !== null;
  }

  /** Uploads each kind of plan that has items, and clears those that the plan has lost. */
  async upload(vehicle: Vehicle): Promise<boolean> {
    // Edits made meanwhile are not sent: the vehicle gets one plan.
    const { plan } = editor;
    const ok = await this.run(true, vehicle, async (kind) => {
      const items = itemsOf(withoutKept(plan), kind);
      if (items.length === 0) {
        if (!held(vehicle, kind)?.length) return;
        await vehicle.clearPlan(kind);
      } else await vehicle.uploadPlan(kind, { items: apiItems(items), home: plan.home }, this.report);
      remember(vehicle, kind, items);
      toast('ok', t('plan.uploaded', { kind: t(`plan.${kind}`), count: items.length }));
    });
    const isWhole = KINDS.every((kind) => vehicle.capabilities[kind] !== false || isEmpty(plan, kind));
    if (ok && isWhole) editor.keep(plan);
    return ok;
  }

  /** Downloads all kinds of plans that the vehicle has. */
  async download(vehicle: Vehicle): Promise<boolean> {
    let plan: Plan = {
      ...editor.plan,
      firmware: vehicle.state.autopilot,
      vehicleType: vehicle.state.mavType,
    };
    const ok = await this.run(false, vehicle, async (kind) => {
      const found = await vehicle.downloadPlan(kind, this.report);
      plan = withPlan(plan, kind, found);
      remember(vehicle, kind, itemsOf(plan, kind));
      toast('ok', t('plan.downloaded', { kind: t(`plan.${kind}`), count: found.items.length }));
    });
    if (ok) editor.load(plan);
    return ok;
  }

  async clear(vehicle: Vehicle, kind: PlanKind): Promise<boolean> {
    return this.run(true, vehicle, async (each) => {
      if (each !== kind) return;
      await vehicle.clearPlan(kind);
      remember(vehicle, kind, []);
      toast('ok', t('plan.cleared', { kind: t(`plan.${kind}`) }));
    });
  }

  private readonly report = (done: number, total: number | null): void => {
    this.done = done;
    this.total = total;
  };

  private async run(isUpload: boolean, vehicle: Vehicle, work: (kind: PlanKind) => Promise<void>): Promise<boolean> {
    if (this.isRunning) return false;
    this.isUpload = isUpload;
    try {
      for (const kind of KINDS) {
        if (vehicle.capabilities[kind] === false) {
          if (isUpload && !isEmpty(editor.plan, kind))
            toast('warning', t('plan.unsupported', { kind: t(`plan.${kind}`) }));
          continue;
        }
        this.kind = kind;
        this.report(0, null);
        await work(kind);
      }
      return true;
    } catch (error) {
      toastError(error);
      return false;
    } finally {
      this.kind = null;
    }
  }
}

export const transfer = new Transfer();

export function itemsOf(plan: Plan, kind: PlanKind): readonly Item[] {
  if (kind === 'mission') return plan.mission;
  return kind === 'fence' ? fenceItems(plan) : rallyItems(plan.rally);
}

/** Returns a plan with one kind that was downloaded. */
export function withPlan(plan: Plan, kind: PlanKind, found: VehiclePlan): Plan {
  const items = fromApi(found.items);
  if (kind === 'mission') return { ...plan, mission: items, home: found.home ?? plan.home };
  if (kind === 'rally') return { ...plan, rally: rallyPoints(items) };
  const { problems, ...areas } = fenceAreas(items);
  for (const problem of problems) toast('warning', problem);
  return { ...plan, ...areas };
}

const keyOf = (vehicle: Vehicle, kind: PlanKind): string => `${vehicle.system} ${kind}`;

function held(vehicle: Vehicle, kind: PlanKind): readonly Item[] | undefined {
  return editor.held[keyOf(vehicle, kind)];
}

function remember(vehicle: Vehicle, kind: PlanKind, items: readonly Item[]): void {
  editor.held = { ...editor.held, [keyOf(vehicle, kind)]: items };
}

/** Returns whether the plan differs from the one on the vehicle; null if that is not known. */
export function differs(vehicle: Vehicle, kind: PlanKind): boolean | null {
  const known = held(vehicle, kind);
  return known === undefined ? null : JSON.stringify(known) !== JSON.stringify(itemsOf(editor.plan, kind));
}
