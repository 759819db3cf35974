/** The requests of the station's API, as its OpenAPI description has them. */

import type { components, paths } from '../../generated/api';

/** The models of requests and answers by their names. */
export type Models = components['schemas'];

type VehiclePath<Name extends string> = `/api/vehicles/{system}/${Name}`;
type Posted<Path extends keyof paths> = paths[Path] extends {
  post: { requestBody?: { content: { 'application/json': infer Body } } };
}
  ? Body
  : never;

/** The actions of a vehicle: the ends of their paths. */
export type ActionName = {
  [Path in keyof paths]: Path extends VehiclePath<infer Name>
    ? paths[Path] extends { post: { parameters: { query?: { accepted?: boolean } } } }
      ? Name
      : never
    : never;
}[keyof paths];

/** The fields of an action. */
export type ActionFields<Name extends ActionName> = Posted<VehiclePath<Name>>;
