import { MeshStandardMaterial } from 'three';

/** How a part of the figure looks for how far it is believed. Colour is for what was seen; everything else is grey. */
export interface Palette {
  seen: MeshStandardMaterial;
  guessed: MeshStandardMaterial;
  unknown: MeshStandardMaterial;
}

const GUESSED = new MeshStandardMaterial({ color: 0xa6acb5, roughness: 0.85 });
const UNKNOWN = new MeshStandardMaterial({ color: 0xb9bec6, roughness: 0.9, transparent: true, opacity: 0.42 });

function palette(color: number): Palette {
  return { seen: new MeshStandardMaterial({ color, roughness: 0.62 }), guessed: GUESSED, unknown: UNKNOWN };
}

export const BODY = palette(0x2f6fc4);
/** The left limbs are lighter than the right, so that front and back cannot be confused. */
export const LEFT = palette(0x56a0e8);
export const RIGHT = palette(0x2459a6);
export const SKIN = palette(0x3d7ed2);
export const VISOR = palette(0x16325c);
/** Hands and feet are drawn along, not measured: they never take part in the colours. */
export const DRAWN = palette(0x3b4656);
