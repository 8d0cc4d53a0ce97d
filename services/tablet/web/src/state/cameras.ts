/** What several cameras say together, where each alone would say it again and again. */

import type { CameraStatus } from '../protocol/messages';

/** Slowness that the box causes, not the camera. */
const OF_THE_BOX: ReadonlySet<CameraStatus['reason']> = new Set(['behind', 'backlog', 'sparse']);
/** A camera that sends hardly more than is looked at is slow by itself. */
const SOURCE_MARGIN = 1.25;

/** No camera works yet, and at least one is about to: nothing can be said of who is in view. */
export function gettingReady(cameras: readonly CameraStatus[]): boolean {
  const working = cameras.some((camera) => camera.state === 'ok' || camera.state === 'slow');
  return !working && cameras.some((camera) => camera.state === 'starting');
}

/** All cameras are slow, and all because the box has too much to do. */
export function boxIsBusy(cameras: readonly CameraStatus[]): boolean {
  return cameras.length > 0 && cameras.every(slowedByTheBox);
}

/** Numbers of the cameras, from 1, that are slow, by who is to blame. */
export function slowCameras(cameras: readonly CameraStatus[]): { byThemselves: number[]; byTheBox: number[] } {
  const numbers = (blamed: boolean): number[] =>
    cameras.flatMap((camera, index) =>
      camera.state === 'slow' && slowedByTheBox(camera) === blamed ? [index + 1] : [],
    );
  return { byThemselves: numbers(false), byTheBox: numbers(true) };
}

/** Numbers of the cameras, from 1, that the box starts no more. */
export function givenUp(cameras: readonly CameraStatus[]): number[] {
  return cameras.flatMap((camera, index) => (camera.reason === 'given_up' ? [index + 1] : []));
}

function slowedByTheBox(camera: CameraStatus): boolean {
  if (camera.state !== 'slow' || !OF_THE_BOX.has(camera.reason)) return false;
  return camera.source_hz === null || camera.fresh_hz === null || camera.source_hz > SOURCE_MARGIN * camera.fresh_hz;
}
