import { MavCmd } from '$generated';

import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';

import { Editor } from './editor.svelte';
import { readPlan, writePlan } from './formats';
import { withParam, type Plan } from './logic/model';
import { patternRuns } from './logic/patterns';

class Storage {
  private readonly values = new Map<string, string>();
  getItem = (key: string): string | null => this.values.get(key) ?? null;
  setItem = (key: string, value: string): void => void this.values.set(key, value);
}

beforeEach(() => {
  vi.useFakeTimers();
  vi.stubGlobal('localStorage', new Storage());
});
afterEach(() => {
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

const AREA = [
  [47.397, 8.545],
  [47.398, 8.545],
  [47.398, 8.547],
  [47.397, 8.547],
].map(([latitude, longitude]) => ({ latitude: latitude!, longitude: longitude! }));

function surveyed(editor: Editor, tool: 'survey' | 'corridor' = 'survey'): Plan {
  editor.setTool(tool);
  editor.draft = tool === 'survey' ? AREA : AREA.slice(0, 3);
  editor.start = 1;
  editor.finishDrawing();
  return editor.plan;
}

describe('work that is neither in a file nor on a vehicle', () => {
  it('is known after the page was opened again', () => {
    const editor = new Editor();
    surveyed(editor);
    expect(editor.hasUnsavedWork).toBe(true);
    editor.store();
    expect(new Editor().hasUnsavedWork).toBe(true);
    editor.keep(editor.plan);
    const again = new Editor();
    expect([again.plan.mission.length > 0, again.hasUnsavedWork]).toEqual([true, false]);
    again.replaceItem(0, { ...again.plan.mission[0]!, frame: 0 });
    vi.advanceTimersByTime(1000);
    expect([again.hasUnsavedWork, new Editor().hasUnsavedWork]).toEqual([true, true]);
  });

  it('is none after a download', () => {
    const editor = new Editor();
    const plan = surveyed(new Editor());
    editor.load(plan);
    expect([editor.hasUnsavedWork, new Editor().hasUnsavedWork]).toEqual([false, false]);
  });
});

describe('a survey', () => {
  it.each(['survey', 'corridor'] as const)('stays a %s in a file of QGroundControl, and in the browser', (tool) => {
    const editor = new Editor();
    const plan = surveyed(editor, tool);
    const file = JSON.parse(writePlan(plan, 'plan', '')) as { mission: { items: Record<string, unknown>[] } };
    const [takeoff, survey, back, ...rest] = file.mission.items;
    expect([takeoff!.command, back!.command, rest]).toEqual([MavCmd.NAV_TAKEOFF, MavCmd.NAV_RETURN_TO_LAUNCH, []]);
    expect(survey).toMatchObject({
      type: 'ComplexItem',
      complexItemType: tool === 'survey' ? 'survey' : 'CorridorScan',
    });
    const { plan: read, notes } = readPlan(JSON.stringify(file));
    expect(notes).toEqual([]);
    expect(read.mission).toEqual(plan.mission);
    expect(JSON.parse(writePlan(read, 'plan', ''))).toEqual(file);
    editor.store();
    expect(patternRuns(new Editor().plan)).toEqual(patternRuns(plan));
  });

  it('has in a file what QGroundControl asks for', () => {
    const file = JSON.parse(writePlan(surveyed(new Editor()), 'plan', '')) as {
      // biome-ignore lint/suspicious/noExplicitAny: the shape of the file is what is tested
      mission: { items: Record<string, any>[] };
    };
    const survey = file.mission.items[1]!;
    const style = survey.TransectStyleComplexItem;
    // The required keys of SurveyComplexItem, TransectStyleComplexItem, CameraCalc and CameraSpec.
    const types = (of: Record<string, unknown>) =>
      Object.fromEntries(
        Object.entries(of).map(([key, value]) => [key, Array.isArray(value) ? 'array' : typeof value]),
      );
    expect(types(survey)).toMatchObject({
      version: 'number',
      angle: 'number',
      entryLocation: 'number',
      flyAlternateTransects: 'boolean',
      splitConcavePolygons: 'boolean',
      polygon: 'array',
    });
    expect(types(style)).toMatchObject({
      version: 'number',
      TurnAroundDistance: 'number',
      CameraTriggerInTurnAround: 'boolean',
      HoverAndCapture: 'boolean',
      Refly90Degrees: 'boolean',
      CameraCalc: 'object',
      VisualTransectPoints: 'array',
      Items: 'array',
      CameraShots: 'number',
      FollowTerrain: 'boolean',
    });
    expect(types(style.CameraCalc)).toMatchObject({
      version: 'number',
      CameraName: 'string',
      AdjustedFootprintSide: 'number',
      AdjustedFootprintFrontal: 'number',
      DistanceToSurface: 'number',
      DistanceToSurfaceRelative: 'boolean',
      ValueSetIsDistance: 'boolean',
      ImageDensity: 'number',
      FrontalOverlap: 'number',
      SideOverlap: 'number',
      SensorWidth: 'number',
      SensorHeight: 'number',
      ImageWidth: 'number',
      ImageHeight: 'number',
      FocalLength: 'number',
      Landscape: 'boolean',
      FixedOrientation: 'boolean',
      MinTriggerInterval: 'number',
    });
    expect(style.Items.map((each: { doJumpId: number }) => each.doJumpId)).toEqual(
      style.Items.map((_: unknown, index: number) => index + 2),
    );
    expect(style.VisualTransectPoints[0]).toEqual(style.Items[0].params.slice(4, 6));
    expect(survey.polygon).toEqual(AREA.map(({ latitude, longitude }) => [latitude, longitude]));
  });

  it('of a file is drawn again with its settings, and replaced', () => {
    const editor = new Editor();
    const plan = readPlan(writePlan(surveyed(new Editor()), 'plan', '')).plan;
    editor.load(plan);
    const [run] = patternRuns(plan);
    editor.pattern.value = { ...editor.pattern.value, turnaround: 99, camera: '' };
    editor.altitude.value = 11;
    editor.editPattern(run!);
    expect([editor.tool, editor.draft, editor.start, editor.altitude.value, editor.pattern.value.turnaround]).toEqual([
      'survey',
      AREA,
      1,
      30,
      10,
    ]);
    editor.finishDrawing();
    expect(editor.plan.mission).toEqual(plan.mission);
    editor.editPattern(patternRuns(editor.plan)[0]!);
    editor.altitude.value = 60;
    editor.finishDrawing();
    const [changed] = patternRuns(editor.plan);
    expect(editor.plan.mission.at(0)?.command).toBe(MavCmd.NAV_TAKEOFF);
    expect(editor.plan.mission.at(-1)?.command).toBe(MavCmd.NAV_RETURN_TO_LAUNCH);
    expect(changed!.end - changed!.start).toBe(editor.plan.mission.length - 2);
    expect(changed!.pattern.items[0]!.params[6]).toBe(60);
    expect(editor.plan.patterns).toHaveLength(1);
  });

  it('is one still after a vehicle has rounded its places, and none after one item was moved', () => {
    const plan = surveyed(new Editor());
    const rounded = plan.mission.map((each) => ({
      ...each,
      params: each.params.map((value) => (value === null ? null : Math.round(value * 1e7) / 1e7)),
    }));
    expect(patternRuns({ ...plan, mission: rounded })).toHaveLength(1);
    const moved = plan.mission.map((each, index) => (index === 3 ? withParam(each, 5, 47.5) : each));
    expect(patternRuns({ ...plan, mission: moved })).toEqual([]);
    const file = JSON.parse(writePlan({ ...plan, mission: moved }, 'plan', '')) as {
      mission: { items: { type: string }[] };
    };
    expect(new Set(file.mission.items.map(({ type }) => type))).toEqual(new Set(['SimpleItem']));
  });
});
