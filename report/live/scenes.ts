// The pairs that the page makes itself.
import type { SdmWorker } from 'sdm';
import { clothOnBall } from './cloth';
import { figureInBox } from './figure';
import { letters } from './letters';
import type { Scene } from './scene';

/// The scenes, by their names in `?scene=`.
export const kScenes: Record<string, { title: string; make: (worker: SdmWorker) => Promise<Scene> }> = {
  letters: { title: 'Letters E and G', make: letters },
  figure: { title: 'Figure in a box', make: async () => figureInBox() },
  cloth: { title: 'Cloth on a ball', make: async () => clothOnBall() },
};
