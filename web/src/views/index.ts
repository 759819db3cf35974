/** The views of the station, by the name in the address (`#/fly`). A view is loaded when it is first shown. */

import type { Component } from 'svelte';

import type { IconName } from '$lib/ui/icons';

export interface View {
  readonly name: ViewName;
  readonly icon: IconName;
  /** Key that shows the view, after `g`. */
  readonly key: string;
  readonly load: () => Promise<{ default: Component }>;
}

export type ViewName =
  | 'fly'
  | 'plan'
  | 'swarm'
  | 'setup'
  | 'inspect'
  | 'logs'
  | 'dashboards'
  | 'router'
  | 'generator'
  | 'msp';

export const views: readonly View[] = [
  { name: 'fly', icon: 'fly', key: '1', load: () => import('./fly/index.svelte') },
  { name: 'plan', icon: 'plan', key: '2', load: () => import('./plan/index.svelte') },
  { name: 'setup', icon: 'setup', key: '3', load: () => import('./setup/index.svelte') },
  { name: 'inspect', icon: 'inspect', key: '4', load: () => import('./inspect/index.svelte') },
  { name: 'logs', icon: 'logs', key: '5', load: () => import('./logs/index.svelte') },
  { name: 'dashboards', icon: 'dashboards', key: '6', load: () => import('./dashboards/index.svelte') },
  { name: 'router', icon: 'router', key: '7', load: () => import('./router/index.svelte') },
  { name: 'swarm', icon: 'group', key: '9', load: () => import('./swarm/index.svelte') },
  { name: 'generator', icon: 'generator', key: '8', load: () => import('./generator/index.svelte') },
  { name: 'msp', icon: 'usb', key: '0', load: () => import('./msp/index.svelte') },
];
