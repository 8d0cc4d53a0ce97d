import { CustomBlending, MeshLambertMaterial, OneFactor, OneMinusSrcAlphaFactor, SrcAlphaFactor } from 'three';

/** How a part of the figure looks for how far it is believed. Colour is for what was seen; everything else is grey. */
export interface Palette {
  seen: MeshLambertMaterial;
  guessed: MeshLambertMaterial;
  unknown: MeshLambertMaterial;
}

const GUESSED = new MeshLambertMaterial({ color: 0xa9adb3 });
const UNKNOWN = new MeshLambertMaterial({ color: 0xb4b8be, transparent: true, opacity: 0.42 });

function palette(color: number): Palette {
  return { seen: new MeshLambertMaterial({ color }), guessed: GUESSED, unknown: UNKNOWN };
}

export const BODY = palette(0x3f7fd0);
/** The left limbs are lighter than the right, so that front and back cannot be confused. */
export const LEFT = palette(0x63a6ea);
export const RIGHT = palette(0x3168b4);
export const SKIN = palette(0x5490da);
export const VISOR = palette(0x1c3763);
/** Hands and feet are drawn along, not measured. Dark, but no grey: a forearm that was seen must not end in a hand that looks unsure. */
export const DRAWN = palette(0x1b4390);
/** The same where the figure is judged: of no colour that means a judgement, and no grey, which is "not sure". */
export const ALONG = new MeshLambertMaterial({ color: 0xe6d3b8 });

/**
 * The standard where it stands in the pupil's place: seen through, and always behind him, as nothing may change the colours on the
 * pupil. It is drawn before him, so it mixes with the background on its own; what is drawn first keeps its inside from being seen.
 */
export const GHOST = new MeshLambertMaterial({
  color: 0x3d63c9,
  opacity: 0.4,
  blending: CustomBlending,
  blendSrc: SrcAlphaFactor,
  blendDst: OneMinusSrcAlphaFactor,
  blendSrcAlpha: OneFactor,
  blendDstAlpha: OneMinusSrcAlphaFactor,
});
export const GHOST_INSIDE = new MeshLambertMaterial({ colorWrite: false });
