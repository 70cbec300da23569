use super::Boundary::*;
use super::*;
use crate::field::Field;
use crate::grid::{GHOST, Grid, Location};

fn still() -> Prescribed {
    Box::new(|_, _| [0.0; 3])
}

fn row(grid: &Grid<f64>, field: &Field<f64>) -> Vec<f64> {
    let start = grid.at([0, 0, 0]) - GHOST;
    field.data[start..start + grid.padded()[0]].to_vec()
}

fn applied(low: Boundary, high: Boundary, location: usize, prescribed: Prescribed) -> Vec<f64> {
    let grid = Grid { cells: [4, 1, 1], spacing_m: [1.0; 3], boundary: [[low, high], [Wrap; 2], [Wrap; 2]] };
    let mut field = Field::zeros(&grid, Location::Face(location));
    field.fill(&grid, |[x, ..]| 1.0 + x);
    BoundaryConditions::new(&grid, prescribed).apply_to_component(&mut field);
    row(&grid, &field)
}

#[test]
fn normal_velocity_follows_each_boundary_condition() {
    assert_eq!(applied(Wrap, Wrap, 0, still())[..8], [3.0, 4.0, 1.0, 2.0, 3.0, 4.0, 1.0, 2.0]);
    assert_eq!(applied(FreeSlip, Reflect, 0, still()), [-3.0, -2.0, 0.0, 2.0, 3.0, 4.0, 0.0, -4.0, -3.0]);
    assert_eq!(applied(NoSlip, Lid { velocity_m_per_s: [0.0, 7.0, 0.0] }, 0, still()), [3.0, 2.0, 0.0, 2.0, 3.0, 4.0, 0.0, 4.0, 3.0]);
    assert_eq!(applied(FreeSlip, Outflow, 0, still()), [-3.0, -2.0, 0.0, 2.0, 3.0, 4.0, 5.0, 4.0, 3.0]);
}

#[test]
fn tangential_velocity_follows_each_boundary_condition() {
    let (lid, inflow): (_, Prescribed) = (Lid { velocity_m_per_s: [0.0, 7.0, 0.0] }, Box::new(|_, _| [0.0, 2.0, 0.0]));
    // Centres lie half a cell inside: the values are 1.5, 2.5, 3.5, 4.5.
    assert_eq!(applied(FreeSlip, NoSlip, 1, still())[..8], [2.5, 1.5, 1.5, 2.5, 3.5, 4.5, -4.5, -3.5]);
    assert_eq!(applied(lid, Outflow, 1, still())[..8], [11.5, 12.5, 1.5, 2.5, 3.5, 4.5, 4.5, 3.5]);
    assert_eq!(applied(Inflow, FreeSlip, 1, inflow)[..8], [1.5, 2.5, 1.5, 2.5, 3.5, 4.5, 4.5, 3.5]);
}

#[test]
fn intermediate_velocity_is_extrapolated_beyond_inflow_faces() {
    let grid = Grid { cells: [4, 1, 1], spacing_m: [1.0f64; 3], boundary: [[Inflow; 2], [Wrap; 2], [Wrap; 2]] };
    for location in [0, 1] {
        let mut field = Field::zeros(&grid, Location::Face(location));
        field.fill(&grid, |[x, ..]| if (1.0..4.0).contains(&x) || location == 1 { 3.0 * x } else { 50.0 });
        let boundaries = BoundaryConditions::new(&grid, still());
        boundaries.apply_to_component_with(&mut field, InflowGhosts::Extrapolated);
        let extended = row(&grid, &field);
        let offset = if location == 0 { 0.0 } else { 0.5 };
        assert!((0..extended.len()).all(|i| extended[i] == 3.0 * (i as f64 - 2.0 + offset)), "{extended:?}");
        boundaries.apply_to_component_with(&mut field, InflowGhosts::Unchanged);
        assert_eq!(row(&grid, &field), extended);
    }
}

#[test]
fn inflow_without_outflow_has_no_net_flux() {
    let prescribed: Prescribed = Box::new(|[x, ..], time| [1.0 + x + time, 0.0, 0.0]);
    let found = applied(Inflow, Inflow, 0, prescribed);
    assert_eq!([found[GHOST], found[GHOST + 4]], [3.0, 3.0]);
}

#[test]
fn velocity_on_faces_of_solid_cells_is_zero() {
    let grid = Grid { cells: [4, 1, 1], spacing_m: [1.0f64; 3], boundary: [[Wrap; 2]; 3] };
    let mut boundaries = BoundaryConditions::new(&grid, still());
    boundaries.set_solid(&[false, false, false, true]);
    let mut field = Field::zeros(&grid, Location::Face(0));
    field.fill(&grid, |_| 1.0);
    boundaries.apply_to_component(&mut field);
    assert_eq!(field.values(&grid).collect::<Vec<_>>(), [0.0, 1.0, 1.0, 0.0]);
}
