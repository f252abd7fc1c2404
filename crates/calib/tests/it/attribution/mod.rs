//! Attribution on drums made of formulas: rates, names, classes, unknowns.

mod rates;
mod world;
