"""Motion for other programs: TRC, C3D, BVH, GLB and OpenSim's .mot. Pure: a take goes in, bytes come out. See docs/exports.md."""
