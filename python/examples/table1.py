"""Table 1 of the founding paper, Mesh I, in ten lines: the reaction at the top of the plate beside the print."""

import stickslip

table = stickslip.Case("plate_mesh1").run(["b-newton", "augmented-lagrangian", "latin", "penalty"]).table("quantities")
rows = zip(table["quantity"], table["at"], table["component"], table["friction"], table["method"], table["value"])
printed = {0.1: 973.3, 0.8: 1107.4, 1.2: 1137.5}
for quantity, at, component, mu, method, value in rows:
    if (quantity, at, component) == ("reaction", "top", "y"):
        print(f"mu = {mu}  {method:22} {-value / 1e6:9.3f} MN/m, printed {printed[mu]}")
        assert abs(-value / 1e6 / printed[mu] - 1) < 1e-3
