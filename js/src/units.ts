// Whether a mesh is in another unit of length than sites.
import { type Body, meshArguments } from './geometry.js';
import { type Module } from './module.js';
import { type Sites } from './sites.js';
import { SdmError } from './types.js';

/** Misfits are estimates: the rms distance of samples of the mesh to the sites, as a fraction of its radius of gyration at that size. */
export interface OtherUnit {
  /** By which the mesh fits: 10, 25.4, 304.8 or 1000, or the inverse of one. */
  factor: number;
  misfit: number;
  misfitAsGiven: number;
  /** The mesh has the box of the sites at that size. */
  sameBox: boolean;
  /** What was found, as a clause. */
  text: string;
}

export function unitCheck(module: Module, body: Body, sites: Sites): OtherUnit | null {
  if (!module.has('sdm_unit_check'))
    throw new SdmError('input', 'unitCheck needs the module of start({ full: true })');
  const values = [...meshArguments(body, 'positions'), sites.handleIn(module)];
  return module.call<{ unit?: OtherUnit }>('sdm_unit_check', values).unit ?? null;
}
