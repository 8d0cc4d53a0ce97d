"""Teaching files for tests: one that is right, and what it may be made of."""

from models.teaching.schema import Vocabulary
from services.evaluation.measures.catalogue import FUNCTIONS
from services.evaluation.signals.catalogue import CATALOGUE

VOCABULARY = Vocabulary(
    {name: CATALOGUE[name] for name in ("knee_flexion", "trunk_forward", "wrist_acceleration")},
    {name: FUNCTIONS[name] for name in ("jump_height",)},
)

GOOD = """
version = 1
action = "squat"

[title]
en = "Squat"
zh = "深蹲"
de = "Kniebeuge"
es = "Sentadilla"

[[shown]]
name = "knee_bend"
signal = "knee_flexion"
over = ["start", "peak"]
take = "max"
unit = "deg"
good = [90, 130]
title.en = "Knee bend"
title.zh = "屈膝"
title.de = "Kniebeugung"
title.es = "Rodillas"

[[fault]]
name = "too_shallow"
importance = 3
cue.en = "Go deeper."
cue.zh = "蹲深一点。"
cue.de = "Geh tiefer."
cue.es = "Baja más."
praise.en = "Nice and deep."
praise.zh = "蹲得很深。"
praise.de = "Schön tief."
praise.es = "Bien abajo."
evidence = [
  { signal = "knee_flexion", over = ["start", "peak"], take = "max", good = 110, fault = 80, weight = 2 },
  { signal = "trunk_forward", at = "peak", shift_s = [-0.1, 0.1], take = "mean", good = 40, fault = 20 },
]

[[fault]]
name = "trunk_forward"
importance = 2
cue.en = "Lift your chest."
cue.zh = "挺起胸部。"
cue.de = "Nimm die Brust hoch."
cue.es = "Levanta el pecho."
praise.en = "Chest up."
praise.zh = "上身很挺。"
praise.de = "Brust oben."
praise.es = "Pecho arriba."
evidence = [{ signal = "trunk_forward", at = "peak", good = 40, fault = 60 }]
"""
