// The page live.html: two bodies whose map is computed here, while they move.
import type { SdmWorker } from 'sdm';
import { byId, make } from '../src/dom';
import { openPage } from '../src/open_page';
import { BakeTab } from './bake_tab';
import { Baking, saveBaked } from './baking';
import { Display } from './display';
import { listenToDrops } from './files';
import { Loading } from './loading';
import { Motion } from './motion';
import { addPanel, kResolutions } from './panel';
import { say } from './status';
import { Probe } from './probe_for_tests';
import { kScenes } from './scenes';
import { Session } from './session';
import { startWorker } from './start';

const kFirst = 'letters';

/// `wanted`: the name of a pair; `map`: the resolution, if it is one of those that can be chosen.
async function open(worker: SdmWorker, wanted: string, map: string | null): Promise<Probe> {
  const session = new Session(worker);
  session.resolution =
    kResolutions.find((n) => String(n) === map) ??
    (window.matchMedia('(max-width: 600px)').matches ? 512 : 1024);
  const display = new Display(session);
  const baking: Baking = new Baking(
    session,
    new BakeTab(
      () => baking,
      () => void baking.update().catch((error) => session.fault(error)),
      () => saveBaked(baking),
      (error) => session.fault(error),
    ),
  );
  const motion = new Motion(session, display, baking);
  const loading = new Loading(session, motion, display, baking);
  const name = Object.hasOwn(kScenes, wanted) ? wanted : kFirst;
  addPanel(name, session.resolution, {
    openScene: (scene) => void loading.openScene(scene),
    openFiles: (files, which) => void loading.openFiles(files, which),
    cancel: () => loading.cancel(),
    swap: () => void loading.swap(),
    convert: () => void loading.convert(),
    setResolution: (resolution) => void loading.setResolution(resolution),
    setFacing: (degrees) => {
      session.engine.setFacing(degrees);
      motion.change();
    },
    setUnits: (units) => {
      session.units = units;
      if (!session.loading) motion.rest();
    },
    setHandles: (handles) => session.pair?.setHandles(handles),
    resetMotion: () => {
      session.pair?.view.resetMotion();
      motion.move();
    },
    togglePlay: () => motion.togglePlay(),
  });
  listenToDrops((files) => void loading.openFiles(files, null));
  document.body.append(make('script', { type: 'application/json', id: 'report' }));
  await loading.openScene(name);
  if (name !== wanted)
    say(`There is no scene “${wanted}”; there are ${Object.keys(kScenes).join(', ')}.`, 'fault');
  if (!session.pair) throw new Error(byId('status').textContent!.replace(/\.$/, ''));
  return new Probe(session, motion, baking);
}

void openPage('sdmLive', 'bodies', 'Is WebGL 2 on in this browser?', async () => {
  byId('message').textContent = 'Starting…';
  const link = new URLSearchParams(window.location.search);
  return open(await startWorker(), link.get('scene') ?? kFirst, link.get('map'));
});
