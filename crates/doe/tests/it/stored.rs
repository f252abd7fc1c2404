//! Models, plans and tables survive being written and read.

use doe::design::full_factorial;
use doe::{Design, DoeError, Factor, Model, ModelTerms};

fn factors() -> Vec<Factor> {
    vec![Factor::new("a", 0.1, 0.9).unwrap(), Factor::new("b", -1.0, 4.0).unwrap()]
}

#[test]
fn a_model_returns_as_it_was() {
    let terms = ModelTerms::saturating(&factors(), "a", 0.2).unwrap();
    let model = Model::new(&factors(), &terms).unwrap();
    let text = serde_json::to_string(&model).unwrap();
    assert_eq!(serde_json::from_str::<Model>(&text).unwrap(), model);
}

#[test]
fn a_stored_model_is_tested_on_reading() {
    let text = r#"{"factors":[{"name":"a","low":1.0,"high":1.0}],"terms":[{"powers":[]}]}"#;
    let error = serde_json::from_str::<Model>(text).unwrap_err().to_string();
    let expected = DoeError::FactorRange { name: "a".into(), low: 1.0, high: 1.0 };
    assert!(error.starts_with(&expected.to_string()), "{error}");
}

#[test]
fn a_plan_returns_as_it_was() {
    let plan = full_factorial(&factors(), &[2, 3]).unwrap().randomised(4);
    let text = serde_json::to_string(&plan).unwrap();
    assert_eq!(serde_json::from_str::<Design>(&text).unwrap(), plan);
}
