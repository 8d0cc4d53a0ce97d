"""Motion from other programs: TRC, C3D and BVH become tracks. Pure but `file.py`. See docs/exports.md."""
