//! Small pictures byte for byte: a change of layout must be meant.

use calib_report::Picture;
use calib_report::pictures::{BarGroup, GroupedBars, LineChart};

#[test]
fn bars_stay_as_they_are() {
    let svg = GroupedBars {
        title: "Bars".into(),
        value_label: "height, mm".into(),
        groups: vec![BarGroup { name: "one".into(), values: vec![Some(1.0)] }],
        decimals: Some(1),
        ..Default::default()
    }
    .svg();
    insta::assert_snapshot!(svg.replace("><", ">\n<"));
}

#[test]
fn no_data_stays_as_it_is() {
    let svg = LineChart { title: "Nothing".into(), ..Default::default() }.svg();
    insta::assert_snapshot!(svg.replace("><", ">\n<"));
}
