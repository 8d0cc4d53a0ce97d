"""The twin: keypoints with the errors that the networks make on rendered pictures, without rendering a picture.

A lesson of 24 s takes minutes to render and to look at; half an hour of walking or a thousand attempts would take days. The twin
says what the edge processes would publish of such a lesson in a small part of its time. It is a bootstrap in time by nearest
neighbours (Lall and Sharma, "A nearest neighbor bootstrap for resampling hydrologic time series", Water Resources Research 32(3),
1996), conditional on the situation: the errors in a picture are those that followed, in some rendered lesson, on alike errors in an
alike situation.

    make twin:           rendered lessons -> truth.Stream -> context (the situation), errors (what was wrong) -> library.Library
    Twin.observations:   lesson.Lesson -> truth.Truth -> context -> bootstrap.Walker -> errors -> speech -> Observation

Why not a formula: errors of pose networks are biased by view and pose, correlated over time and between joints, heavy-tailed, they
jump when left and right are mistaken, and the score knows of some of that. Each is easily written down and all of them together are
not; the library has them together. What the plain bootstrap gets wrong is put right where it was measured:

- Swaps and losses are drawn apart, before the errors (`walk.walk`): among a few neighbours that are alike in everything there is
  seldom a rare one, and swaps came out half as often as they should.
- A neighbour's errors before are never quite the present ones. What of the difference is still there one picture later is carried
  on (`Settings.carry`): without that, errors forget too soon. This is the modified bootstrap of Prairie et al. ("Modified K-NN
  model for stochastic streamflow simulation", J. Hydrologic Engineering 11(4), 2006) with the neighbours' slope for its regression.
- A swapped keypoint is told relative to the joint that it is on (`errors`), since the way there is another in every picture.
- Every entry counts in the mirror, too, which doubles the library for nothing.
- Body parts have neighbours of their own where that came out better (`parts`, `fit`).

It knows nothing of what no rendered lesson showed: other rates (refused), other networks, people whom the camera sees from nearer
than any it saw. It closes no loop: where fusion lost the pupil and a camera looked at the wrong place, the twin says what was said
then, but not because fusion lost the pupil now. `agreement` is what it is worth.
"""
