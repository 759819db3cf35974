/** English texts, one file for the shell and for each view. */

import { dashboards } from './dashboards';
import { fly } from './fly';
import { generator } from './generator';
import { inspect } from './inspect';
import { logs } from './logs';
import { maps } from './maps';
import { msp } from './msp';
import { payload } from './payload';
import { plan } from './plan';
import { preflight } from './preflight';
import { router } from './router';
import { setup } from './setup';
import { shell } from './shell';
import { sources } from './sources';
import { swarm } from './swarm';
import { ui } from './ui';

export const en = {
  shell,
  ui,
  sources,
  fly,
  maps,
  msp,
  payload,
  plan,
  preflight,
  swarm,
  setup,
  inspect,
  logs,
  dashboards,
  router,
  generator,
};
