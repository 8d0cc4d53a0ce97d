"""Motions of real people, recorded by optical markers, as motions of the body.

Bytes of a .trc or .csv file -> Markers -> fit (shape, places of the markers on the bones, a pose a frame) -> Motion at
`models.motions.motion.RATE_HZ`. Pure, as all of models.
"""
