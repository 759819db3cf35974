import { expectTypeOf, test } from 'vitest';
import type { ActionFields, ActionName } from './requests';

/** `npm run check` judges the types. */
test('actions have the fields of the description', () => {
  expectTypeOf<'mission/current'>().toExtend<ActionName>();
  expectTypeOf<'fly'>().not.toExtend<ActionName>();
  expectTypeOf<'command'>().not.toExtend<ActionName>(); // it has no answer on acceptance
  expectTypeOf<{ latitude: number; longitude: number }>().toExtend<ActionFields<'goto'>>();
  expectTypeOf<{ latitude: number }>().not.toExtend<ActionFields<'goto'>>();
  expectTypeOf<{ mode: boolean }>().not.toExtend<ActionFields<'mode'>>();
});
