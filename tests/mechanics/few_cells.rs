//! Cracks of few cells: short, beside each other, in flat cells.

use crate::common::*;

/// A plate 4 × 4 m whose top is pushed down by 1 mm: cells, cracks with their friction, how far the top is pushed aside [m], and the
/// dissipation for a Young's modulus of 1e10 Pa [J/m].
struct Plate {
    name: &'static str,
    cells: [usize; 2],
    cracks: &'static [&'static [[f64; 2]]],
    friction: f64,
    aside_m: f64,
    dissipation: f64,
}

/// Source: own conforming P2 triangles, refined to the tips (1/120 of the shortest crack there, 2 mm at most); on 0.6 times the size
/// they move by at most 0.3 %.
const PLATES: [Plate; 11] = [
    Plate {
        name: "kinked, legs of 2.2 and 1.1 cells",
        cells: [43, 43],
        cracks: &[&[[-0.3031, -0.0244], [-0.1653, -0.1704], [-0.0618, -0.1887]]],
        friction: 0.12,
        aside_m: 0.000104,
        dissipation: 1.1964,
    },
    Plate {
        name: "kinked, legs of 1.0 and 2.2 cells",
        cells: [47, 47],
        cracks: &[&[[-0.0818, 0.1098], [-0.0135, 0.0626], [0.0221, -0.1237]]],
        friction: 0.2,
        aside_m: -0.000531,
        dissipation: 0.7658,
    },
    Plate {
        name: "from a side, 3.9 cells",
        cells: [40, 40],
        cracks: &[&[[-2.0, 0.3749], [-1.7097, 0.6359]]],
        friction: 0.23,
        aside_m: -0.000121,
        dissipation: 6.1235,
    },
    Plate {
        name: "from a side, 2.4 cells",
        cells: [50, 50],
        cracks: &[&[[-2.0, -0.4973], [-1.8187, -0.5484]]],
        friction: 0.16,
        aside_m: -0.000209,
        dissipation: 0.67932,
    },
    Plate {
        name: "3.5 cells from a long one",
        cells: [45, 45],
        cracks: &[
            &[[-0.7248, -0.4266], [0.1823, 0.1168]],
            &[[-0.05728552215, -0.026724167938], [0.2278, -0.1536]],
        ],
        friction: 0.15,
        aside_m: 0.000479,
        dissipation: 22.4995,
    },
    Plate {
        name: "two that cross, 5.0 and 1.5 cells",
        cells: [56, 56],
        cracks: &[
            &[[0.138, -0.1355], [0.3562, -0.4162]],
            &[[0.2106, -0.3174], [0.2836, -0.2343]],
        ],
        friction: 0.28,
        aside_m: -0.000449,
        dissipation: 4.3803,
    },
    Plate {
        name: "3.8 cells beside a long one",
        cells: [53, 53],
        cracks: &[
            &[[-0.78541, 0.0971], [0.2721, 0.1155]],
            &[[-0.5664, 0.2197], [-0.2902, 0.298]],
        ],
        friction: 0.07,
        aside_m: 0.000545,
        dissipation: 4.5930,
    },
    Plate {
        name: "parallel at 1.7 cells",
        cells: [46, 46],
        cracks: &[
            &[[-0.5774, -0.2118], [0.2098, 0.0304]],
            &[[-0.5427, -0.0488], [0.2229, 0.1868]],
        ],
        friction: 0.15,
        aside_m: -0.000083,
        dissipation: 15.0386,
    },
    Plate {
        name: "parallel at 0.9 cells",
        cells: [43, 43],
        cracks: &[
            &[[-0.3808, -0.0358], [0.3125, -0.2565]],
            &[[-0.5102, 0.0931], [0.0015, -0.0698]],
        ],
        friction: 0.14,
        aside_m: -0.000359,
        dissipation: 3.4331,
    },
    Plate {
        name: "cells of 1 : 6, crack of 2.5 of their lengths",
        cells: [9, 54],
        cracks: &[&[[-0.3825, 0.4535], [0.7205, 0.0241]]],
        friction: 0.12,
        aside_m: 0.000367,
        dissipation: 27.2825,
    },
    Plate {
        name: "cells of 6 : 1, crack of 1.6 of their heights",
        cells: [48, 8],
        cracks: &[&[[-0.057, 0.6493], [0.5627, -0.1527]]],
        friction: 0.33,
        aside_m: -0.000095,
        dissipation: 31.1544,
    },
];

/// With the tips and the contact space that the program chooses.
fn default_crack(path: &[[f64; 2]], friction: f64) -> String {
    format!("[[crack]]\npoints_m = {path:?}\nfriction = {friction}\n")
}

/// Goal: cracks of few cells dissipate what they should within 2 %: all but one of these were off by 1.9 to 24 %, most of them
/// by more than 3.
#[test]
fn cracks_of_few_cells_dissipate_what_they_should() {
    for plate in &PLATES {
        let one = |path: &&[[f64; 2]]| default_crack(path, plate.friction);
        let top = support("\"top\"", &format!("[{}, -1e-3]", plate.aside_m));
        let rest =
            plate.cracks.iter().map(one).collect::<String>() + &support("\"bottom\"", "[0, 0]");
        let text = plane([-2.0; 2], [2.0; 2], plate.cells, &(rest + &top));
        let text = text.replace("young_pa = 1,", "young_pa = 1e10,");
        let found = value(
            &run(&parse(&text), &[METHOD]),
            |_| true,
            ["dissipation", "", ""],
        );
        let error = found / plate.dissipation - 1.0;
        println!("{} {:+.2} %", plate.name, 100.0 * error);
        assert_below(error.abs(), 0.02, plate.name);
    }
}

/// Source: closed form, slip over the whole length of a crack in an infinite plate. Goal: straight cracks of 1.5 to 4.75 cells,
/// anywhere in the mesh, dissipate what they should within 1 %, and slip as far within 2 %: they were off by 8 to 55 %.
#[test]
fn straight_cracks_of_few_cells_slip_as_far_as_they_should() {
    let (mu, h) = (0.2, 2.0 / 48.0);
    let mut random = Random(7);
    for k in 0..14 {
        let (length, angle) = (h * (1.5 + 0.25 * f64::from(k)), random.between(0.3, 1.0));
        let [x, y] = [0, 1].map(|_| random.between(-0.1, 0.1));
        let (s, c) = angle.sin_cos();
        let (p, q) = ([x, y], [x + length * c, y + length * s]);
        // Pressure on the crack 5e5 Pa, shear 4e5 Pa: 3e5 Pa beyond friction.
        let (n, t, along) = (-5e5, 4e5, -1e6);
        let stress = [
            along * c * c + n * s * s - 2.0 * t * s * c,
            along * s * s + n * c * c + 2.0 * t * s * c,
            (along - n) * s * c + t * (c * c - s * s),
        ];
        let exact = format!(
            "[exact]\nsolution = \"uniform-slip\"\nstress_xx_pa = {}\nstress_yy_pa = {}\nstress_xy_pa = {}\n",
            stress[0], stress[1], stress[2]
        );
        let sides = ["left", "right", "bottom", "top"];
        let held: String = sides
            .map(|side| support(&format!("{side:?}"), "\"exact\""))
            .concat();
        let text = plane(
            [-1.0; 2],
            [1.0; 2],
            [48, 48],
            &(default_crack(&[p, q], mu) + &exact + &held),
        );
        let found = run(&parse(&text), &[METHOD]);
        let own = |quantity| value(&found, |_| true, [quantity, "", ""]);
        // d = 4 (1 − ν²)/E τ √(a² − x²),   τ = 4e5 − 0.2 · 5e5,   against half of the friction in the mean
        let slip = 4.0 * (1.0 - 0.09) * 3e5 * 0.5 * length;
        let dissipation = 0.5e5 * slip * std::f64::consts::FRAC_PI_4 * length;
        let [d, w] = [own("max_slip") / slip, own("dissipation") / dissipation].map(|v| v - 1.0);
        let cells = length / h;
        println!(
            "{cells:.1} cells: slip {:+.2} %, dissipation {:+.2} %",
            100.0 * d,
            100.0 * w
        );
        assert_below(w.abs(), 0.01, cells);
        assert_below(d.abs(), 0.02, cells);
    }
}
