//! Attribution on drums made of formulas: rates, names, classes, unknowns.

mod cases;
mod faults;
mod rates;
mod world;
