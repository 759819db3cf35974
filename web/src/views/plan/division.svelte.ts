/** A survey or a corridor that the station's planner divides among several vehicles. */

import { api } from '$lib/api/client';
import { uploadShares, type Share } from '$lib/vehicle/shares';

import type { Editor } from './editor.svelte';
import type { Camera } from './logic/pattern';

/** Degrees that a camera sees along one side of its picture. */
function viewOf(side: number, focalLength: number): number {
  return (2 * Math.atan(side / (2 * focalLength)) * 180) / Math.PI;
}

function cameraOf({ sensorWidth, sensorHeight, focalLength, imageWidth }: Camera): Record<string, number> {
  return {
    horizontal_view: viewOf(sensorWidth, focalLength),
    vertical_view: viewOf(sensorHeight, focalLength),
    width: imageWidth,
  };
}

class Division {
  shares: readonly Share[] = $state.raw([]);
  /** System ids of the vehicles. */
  chosen: readonly number[] = $state.raw([]);
  /** Counts changes of the shape and the vehicles. */
  private change = 0;

  toggle(system: number): void {
    const others = this.chosen.filter((each) => each !== system);
    this.chosen = others.length < this.chosen.length ? others : [...others, system].sort((a, b) => a - b);
    this.clear();
  }

  clear(): void {
    this.change += 1;
    this.shares = [];
  }

  /** Divides the pattern that is drawn. An answer for another shape or other vehicles is dropped. */
  async plan(editor: Editor): Promise<void> {
    const { draft, pattern, camera } = editor;
    const corners = draft.map(({ latitude, longitude }) => [latitude, longitude]);
    const { side, front, width, crosshatch } = pattern.value;
    const area = { outline: corners, bearing: editor.laneAngle, crosshatch };
    const body = {
      ...(editor.tool === 'corridor' ? { route: corners, width } : area),
      spacing: editor.spacing.lanes,
      altitude: editor.altitude.value,
      ...(camera ? { camera: cameraOf(camera), side_overlap: side / 100, front_overlap: front / 100 } : {}),
      vehicles: this.chosen.map((system) => ({ system })),
    };
    this.change += 1;
    const { change } = this;
    const { shares } = await api.post<{ readonly shares: readonly Share[] }>('surveys', body);
    if (change === this.change) this.shares = shares;
  }

  async upload(): Promise<void> {
    await uploadShares(this.shares);
  }
}

export const division = new Division();
