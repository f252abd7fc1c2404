//! Attribution on drums made of formulas: rates, names, classes, unknowns.

mod cases;
mod faults;
mod hidden;
mod linear;
mod loads;
mod optima;
mod pairs;
mod rates;
mod thesis;
mod world;
