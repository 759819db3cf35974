/** The plan that is edited, with its history, selection, tool and the drawing that is under way. */

import { MavCmd, MavFrame } from '$generated';
import { Persisted } from '$lib/store/settings.svelte';

import { check, type Problem } from './logic/checks';
import { itemPosition, newItem } from './logic/commands';
import { corridorLanes } from './logic/corridor';
import { area, pathLength, type Point } from './logic/geo';
import { draftPlan, draftText } from './logic/draft';
import { has, moved, removed, type Selection } from './logic/edits';
import { begin, commit, redo, undo, type History } from './logic/history';
import {
  changedAt,
  insertItems,
  isEmpty,
  moveItem,
  replaceItem,
  waypoint,
  type Item,
  type Place,
  type Plan,
  type PlanKind,
} from './logic/model';
import { altitudeFor, CAMERAS, PATTERN, spacingOf, summaryOf, type Camera, type Lane } from './logic/pattern';
import { isWing } from './logic/path';
import { patternOf, shapeOf, withPattern, type PatternRun } from './logic/patterns';
import { statisticsOf } from './logic/statistics';
import { fewestLanesAngle, surveyLanes } from './logic/survey';
import type { Profile } from './logic/terrain';
import { currentItemOf, firmwareFor, forVehicle, knownHome, placeOfVehicle } from './selectedVehicle';

export type Tool = 'select' | 'waypoint' | 'survey' | 'corridor' | 'polygon' | 'circle' | 'rally' | 'home' | 'return';
export type { Selection } from './logic/edits';

export interface Limits {
  /** Minutes that a full battery lasts; null: not known. */
  readonly endurance: number | null;
  /** Metres. */
  readonly clearance: number;
  readonly ceiling: number | null;
}

/** Tools that draw a line or an area, and how many points they need. */
const DRAWN: Readonly<Partial<Record<Tool, number>>> = { survey: 3, corridor: 2, polygon: 3 };
const NEW_RADIUS = 100;
/** Milliseconds without an edit after which the browser keeps the plan. */
const STORE_DELAY = 300;
export const KINDS: readonly PlanKind[] = ['mission', 'fence', 'rally'];
const ENDS: ReadonlySet<number> = new Set([MavCmd.NAV_RETURN_TO_LAUNCH, MavCmd.NAV_LAND, MavCmd.NAV_VTOL_LAND]);

export class Editor {
  private readonly stored = new Persisted('plan.draft', '');
  private storing: ReturnType<typeof setTimeout> | undefined;
  private history: History<Plan> = $state.raw(begin(draftPlan(this.stored.value)));
  /** Whether a file or a vehicle has the plan that the browser keeps: a page that is opened again must know it. */
  private readonly storedIsKept = new Persisted('plan.draftIsKept', false);
  /** The plan that a file or a vehicle has too; null: none. */
  private kept: Plan | null = $state.raw(this.storedIsKept.value === true ? this.history.present : null);
  selection: Selection | null = $state.raw(null);
  tool: Tool = $state('select');
  /** The points of the line or the area that is drawn. */
  draft: readonly Point[] = $state.raw([]);
  /** Heading of the lanes of a survey; null: along the longest edge. */
  angle: number | null = $state(null);
  start = $state(0);
  /** The pattern that is drawn again; null: a new one. */
  edited: PatternRun | null = $state.raw(null);
  profile: Profile | null = $state.raw(null);
  /** The plans as the vehicle has them, as far as they were downloaded or uploaded; by system id and kind. */
  held: Readonly<Record<string, readonly Item[]>> = $state.raw({});
  name = $state('');

  readonly altitude = new Persisted('plan.altitude', 30);
  readonly frame = new Persisted<number>('plan.frame', MavFrame.GLOBAL_RELATIVE_ALT);
  readonly pattern = new Persisted('plan.pattern', PATTERN);
  readonly limits = new Persisted<Limits>('plan.limits', { endurance: null, clearance: 20, ceiling: 120 });

  readonly plan: Plan = $derived(this.history.present);
  readonly canUndo: boolean = $derived(this.draft.length > 0 || this.history.past.length > 0);
  readonly canRedo: boolean = $derived(this.history.future.length > 0);
  readonly statistics = $derived(statisticsOf(this.plan));
  readonly problems: Problem[] = $derived(
    check({
      plan: this.plan,
      statistics: this.statistics,
      profile: this.profile,
      ...this.limits.value,
      vehicle: placeOfVehicle(),
      wing: isWing(this.plan),
      firmware: firmwareFor(this.plan),
    }),
  );
  /** Whether the plan has work that is in no file and on no vehicle. */
  readonly hasUnsavedWork: boolean = $derived(
    this.plan !== this.kept && KINDS.some((kind) => !isEmpty(this.plan, kind)),
  );

  /** Changes the plan; edits with the same key, such as those of one drag, are undone together. */
  change(plan: Plan, key: string | null = null): void {
    this.turn(commit(this.history, plan, key));
  }

  private turn(history: History<Plan>): void {
    this.history = history;
    clearTimeout(this.storing);
    this.storing = setTimeout(() => this.store(), STORE_DELAY);
  }

  /** Keeps the plan in the browser at once. */
  store(): void {
    clearTimeout(this.storing);
    this.stored.value = draftText(this.plan);
    this.storedIsKept.value = this.plan === this.kept;
  }

  /** Ends a gesture: the next edit is undone alone. */
  endGesture(): void {
    this.history = { ...this.history, key: null };
  }

  /** Takes back the last point of the drawing, or the last edit. */
  undo(): void {
    if (this.draft.length > 0) this.draft = this.draft.slice(0, -1);
    else this.turn(undo(this.history));
    this.clampSelection();
  }

  redo(): void {
    this.turn(redo(this.history));
    this.clampSelection();
  }

  /** Remembers that a file or a vehicle has a plan. */
  keep(plan: Plan): void {
    this.kept = plan;
    this.store();
  }

  /** Replaces the whole plan by one of a file or a vehicle. */
  load(plan: Plan): void {
    this.change(plan);
    this.keep(plan);
    this.selection = null;
    this.setTool('select');
  }

  setTool(tool: Tool): void {
    this.tool = tool;
    [this.edited, this.draft, this.angle, this.start] = [null, [], null, 0];
  }

  /** The number of points that the drawing still needs; null if the tool draws none. */
  get missing(): number | null {
    const needed = DRAWN[this.tool];
    return needed === undefined ? null : Math.max(0, needed - this.draft.length);
  }

  /** Metres per second; a wing has its cruise speed, other vehicles the speed of hovering flight. */
  get speed(): number {
    return isWing(this.plan) ? this.plan.cruiseSpeed : this.plan.hoverSpeed;
  }

  set speed(speed: number) {
    this.change({ ...this.plan, ...(isWing(this.plan) ? { cruiseSpeed: speed } : { hoverSpeed: speed }) });
  }

  /** The number of the item that the vehicle flies to, from 1; null if its mission is not the one that is shown. */
  get currentItem(): number | null {
    return currentItemOf(this.plan, this.held);
  }

  get selectedItem(): number | null {
    return this.selection?.kind === 'item' ? this.selection.index : null;
  }

  private clampSelection(): void {
    if (this.selection && !has(this.plan, this.selection)) this.selection = null;
  }

  // Editing

  /** Does what the tool does at a place of the map. */
  click(at: Point): void {
    const { latitude, longitude } = at;
    const place: Place = { latitude, longitude, altitude: this.altitude.value };
    const actions: Partial<Record<Tool, () => void>> = {
      waypoint: () => this.addWaypoint(place),
      circle: () => this.addCircle({ latitude, longitude }),
      rally: () => this.addRally(place),
      home: () => this.setHome({ ...place, altitude: this.plan.home?.altitude ?? 0 }),
      return: () => this.placeReturn(place),
    };
    if (this.missing !== null) this.draft = [...this.draft, { latitude, longitude }];
    else actions[this.tool]?.();
  }

  private addWaypoint(place: Place): void {
    if (this.plan.mission.length === 0) {
      const home = this.plan.home ?? knownHome() ?? { ...place, altitude: 0 };
      const takeoff = newItem(MavCmd.NAV_TAKEOFF, { ...home, altitude: place.altitude }, this.frame.value);
      const first = waypoint(place, place.altitude, this.frame.value);
      this.change(forVehicle({ ...insertItems(this.plan, 0, [takeoff, first]), home }));
      this.selection = { kind: 'item', index: 1 };
      return;
    }
    this.insertAt(this.insertionIndex(), waypoint(place, place.altitude, this.frame.value));
  }

  /** New items come after the selected one; without one at the end, before a landing or a return. */
  private insertionIndex(): number {
    const { mission } = this.plan;
    if (this.selectedItem !== null) return this.selectedItem + 1;
    const last = mission.at(-1);
    return last && ENDS.has(last.command) ? mission.length - 1 : mission.length;
  }

  insertAt(index: number, added: Item): void {
    this.change(insertItems(this.plan, index, [added]));
    this.selection = { kind: 'item', index };
  }

  /** Adds an item of a command after the selected one, at its place. */
  addCommand(command: number): void {
    const index = ENDS.has(command) && this.selectedItem === null ? this.plan.mission.length : this.insertionIndex();
    this.insertAt(index, newItem(command, this.placeNear(index), this.frame.value));
  }

  /** The place of the items before an index, or a known one. */
  placeNear(index: number): Place {
    const before = this.plan.mission
      .slice(0, index)
      .reverse()
      .map(itemPosition)
      .find((each) => each !== null);
    const at = before ?? this.plan.home ?? knownHome() ?? { latitude: 0, longitude: 0 };
    return { latitude: at.latitude, longitude: at.longitude, altitude: this.altitude.value };
  }

  replaceItem(index: number, changed: Item, key: string | null = null): void {
    this.change(replaceItem(this.plan, index, changed), key);
  }

  moveItem(from: number, to: number): void {
    this.change(moveItem(this.plan, from, to));
    this.selection = { kind: 'item', index: Math.max(0, Math.min(to, this.plan.mission.length - 1)) };
  }

  private addCircle(center: Point): void {
    const circles = [...this.plan.circles, { inclusion: true, center, radius: NEW_RADIUS }];
    this.change({ ...this.plan, circles });
    this.selection = { kind: 'circle', index: circles.length - 1 };
    this.setTool('select');
  }

  private addRally(place: Place): void {
    this.change({ ...this.plan, rally: [...this.plan.rally, place] });
    this.selection = { kind: 'rally', index: this.plan.rally.length - 1 };
  }

  private setHome(home: Place): void {
    this.change({ ...this.plan, home });
    this.selection = { kind: 'home' };
    this.setTool('select');
  }

  private placeReturn(returnPoint: Place): void {
    this.change({ ...this.plan, returnPoint });
    this.selection = { kind: 'return' };
    this.setTool('select');
  }

  /** Turns the drawing into a fence polygon, or the items of a pattern. */
  finishDrawing(): void {
    if (this.missing !== 0) return;
    if (this.tool === 'polygon') {
      const polygons = [...this.plan.polygons, { inclusion: true, vertices: this.draft }];
      this.change({ ...this.plan, polygons });
      this.selection = { kind: 'polygon', index: polygons.length - 1 };
    } else this.insertPattern();
    this.setTool('select');
  }

  /** Moves something on the map; `handle` is a corner of a polygon or a point of the drawing. */
  place(target: Selection | { kind: 'draft' }, at: Point, handle = 0): void {
    if (target.kind === 'draft') {
      this.draft = changedAt(this.draft, handle, { latitude: at.latitude, longitude: at.longitude });
      return;
    }
    const index = 'index' in target ? target.index : 0;
    this.change(moved(this.plan, target, at, handle), `place ${target.kind} ${index} ${handle}`);
  }

  removeSelected(): void {
    const { plan, selection } = this;
    if (!selection || !has(plan, selection)) return;
    this.change(removed(plan, selection));
    const left = this.plan.mission.length;
    const next = 'index' in selection ? Math.min(selection.index, left - 1) : 0;
    this.selection = selection.kind === 'item' && left > 0 ? { kind: 'item', index: next } : null;
  }

  // Patterns

  get camera(): Camera | null {
    return CAMERAS.find((each) => each.name === this.pattern.value.camera) ?? null;
  }

  /** Metres between lanes and between pictures. */
  get spacing(): { lanes: number; pictures: number } {
    const { camera, pattern } = this;
    return camera
      ? spacingOf(camera, this.altitude.value, pattern.value)
      : { lanes: pattern.value.spacing, pictures: pattern.value.pictures ?? 0 };
  }

  /** Centimetres on the ground of a pixel; null without a camera. */
  get resolution(): number | null {
    return this.camera && spacingOf(this.camera, this.altitude.value, this.pattern.value).resolution;
  }

  setResolution(centimetres: number): void {
    if (this.camera) this.altitude.value = Math.round(altitudeFor(this.camera, centimetres) * 10) / 10;
  }

  get laneAngle(): number {
    return this.angle ?? fewestLanesAngle(this.draft);
  }

  /** The lanes of the pattern that is drawn. */
  get lanes(): Lane[] {
    const { crosshatch, width } = this.pattern.value;
    const spacing = this.spacing.lanes;
    if (this.missing !== 0) return [];
    if (this.tool === 'corridor') return corridorLanes(this.draft, { width, spacing, reverse: this.start > 0 });
    if (this.tool !== 'survey') return [];
    return surveyLanes(this.draft, { spacing, angle: this.laneAngle, start: this.start, crosshatch });
  }

  /** Numbers of the pattern that is drawn; null while it is not complete. */
  get patternSummary(): ReturnType<typeof summaryOf> {
    const covered = this.tool === 'survey' ? area(this.draft) : pathLength(this.draft) * this.pattern.value.width;
    return summaryOf(this.lanes, this.spacing.pictures, covered);
  }

  /** Draws a pattern of the mission again, to change its shape or its settings. */
  editPattern(run: PatternRun): void {
    const shape = shapeOf(run.pattern);
    if (shape === null) return;
    this.setTool(shape.tool);
    [this.draft, this.angle, this.start] = [shape.points, shape.angle, shape.start];
    [this.altitude.value, this.frame.value, this.pattern.value] = [shape.altitude, shape.frame, shape.settings];
    this.edited = run;
  }

  private insertPattern(): void {
    const first = this.lanes[0]?.[0];
    if (!first) return;
    const pattern = patternOf(
      {
        tool: this.tool === 'corridor' ? 'corridor' : 'survey',
        points: this.draft,
        angle: this.laneAngle,
        start: this.start,
        altitude: this.altitude.value,
        frame: this.frame.value,
        settings: { ...PATTERN, ...this.pattern.value },
      },
      this.lanes,
    );
    this.selection = null;
    if (this.edited !== null) return this.change(withPattern(this.plan, this.edited, pattern));
    const isFirst = this.plan.mission.length === 0;
    const home = this.plan.home ?? (isFirst ? (knownHome() ?? { ...first, altitude: 0 }) : null);
    const place = { ...(home ?? first), altitude: this.altitude.value };
    const takeoff = isFirst ? [newItem(MavCmd.NAV_TAKEOFF, place, this.frame.value)] : [];
    const back = isFirst ? [newItem(MavCmd.NAV_RETURN_TO_LAUNCH, place)] : [];
    const index = this.insertionIndex();
    const patterns = [...this.plan.patterns, pattern];
    const inserted = { ...insertItems(this.plan, index, [...takeoff, ...pattern.items, ...back]), home, patterns };
    this.change(isFirst ? forVehicle(inserted) : inserted);
  }
}

/** The plan stays while other views are shown. */
export const editor = new Editor();
