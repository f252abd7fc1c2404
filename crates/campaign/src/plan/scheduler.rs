//! Texts for Slurm, GNU parallel and Snakemake: every run by its number, then the table.

use super::manifest::Manifest;

/// The call of the command line that a scheduler repeats.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Call {
    /// Program.
    pub program: String,
    /// Path of the plan.
    pub plan: String,
    /// Folder of the campaign.
    pub folder: String,
    /// Further arguments that belong to the frozen plan.
    pub arguments: Vec<String>,
}

impl Call {
    /// The call without a number, quoted for a shell.
    fn shell(&self) -> String {
        let mut words = vec![quoted(&self.program), "run".to_owned(), quoted(&self.plan)];
        words.extend(["--out".to_owned(), quoted(&self.folder)]);
        words.extend(self.arguments.iter().map(|a| quoted(a)));
        words.join(" ")
    }
}

/// A word as a POSIX shell takes it.
///
/// ```
/// assert_eq!(campaign::plan::quoted("out/a b"), "'out/a b'");
/// ```
pub fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./=:,+@".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        return word.to_owned();
    }
    format!("'{}'", word.replace('\'', "'\\''"))
}

/// A job array for Slurm's `sbatch`: one task a run, one core a task.
///
/// Tasks whose node dies are begun again elsewhere by Slurm, and go on from their checkpoints. Tasks that are killed at
/// their time limit go on when the script is submitted again.
pub fn slurm(manifest: &Manifest, call: &Call) -> String {
    let last = manifest.rows().len().saturating_sub(1);
    let call = call.shell();
    format!(
        "#!/bin/sh\n\
         #SBATCH --job-name=tumble\n\
         #SBATCH --array=0-{last}\n\
         #SBATCH --ntasks=1\n\
         #SBATCH --cpus-per-task=1\n\
         #SBATCH --time=24:00:00\n\
         #SBATCH --requeue\n\
         #SBATCH --signal=B:TERM@60\n\
         # {} runs; submit it again to go on with what is not done, then collect:\n\
         #   {call} --collect\n\
         exec {call} --index \"$SLURM_ARRAY_TASK_ID\"\n",
        last + 1
    )
}

/// One line for GNU parallel, then the table.
pub fn gnu_parallel(manifest: &Manifest, call: &Call) -> String {
    let last = manifest.rows().len().saturating_sub(1);
    // GNU parallel reads its command once more as a shell does: the quotes stay.
    let call = call.shell();
    let command = quoted(&format!("{call} --index {{}}"));
    format!("seq 0 {last} | parallel {command}\n{call} --collect\n")
}

/// A Snakefile: one rule a run, one for the table.
pub fn snakemake(manifest: &Manifest, call: &Call) -> String {
    let last = manifest.rows().len();
    // Python strings take JSON's escapes; Snakemake fills in what is in braces.
    let python = |text: &str| format!("{text:?}");
    let braces = |text: &str| text.replace('{', "{{").replace('}', "}}");
    let shell = braces(&call.shell());
    format!(
        "FOLDER = {folder}\n\
         RUNS = [f\"{{k:04d}}\" for k in range({last})]\n\n\
         rule table:\n\
         \x20   input: [f\"{{FOLDER}}/rows/{{k}}.json\" for k in RUNS]\n\
         \x20   output: FOLDER + \"/responses.csv\"\n\
         \x20   shell: {collect}\n\n\
         rule run:\n\
         \x20   input: {plan}\n\
         \x20   output: FOLDER + \"/rows/{{k}}.json\"\n\
         \x20   shell: {one}\n",
        folder = python(&call.folder),
        plan = python(&braces(&call.plan)),
        collect = python(&format!("{shell} --collect")),
        one = python(&format!("{shell} --index {{wildcards.k}}")),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::Freeze;

    const PLAN: &str = r#"
name = "beads"
factors.friction.pp = [0.2, 0.8]
design.full_factorial = { centre_points = 1 }
drum = { radius_m = 0.02, length_m = 0.02, mantle = "glass", end_plates = "glass" }
particles = { material = "glass", shape = { sphere = { diameter_m = 0.004 } } }
fill.count = 90
friction.mantle = 0.6
restitution = { pp = 0.7, mantle = 0.7 }
rolling = { pp = 0.01, mantle = 0.01 }
run = { speeds_rpm = [60.0] }
[materials]
glass = { density_kg_m3 = 2500.0, poisson_ratio = 0.29, shear_modulus_pa = 2.52e6 }
"#;

    fn call() -> Call {
        Call {
            program: "tumble".to_owned(),
            plan: "my plan's {1}.toml".to_owned(),
            folder: "out".to_owned(),
            arguments: vec!["--coarse".to_owned()],
        }
    }

    #[test]
    fn every_run_has_its_task() {
        let manifest = Manifest::freeze("beads.toml", PLAN, &Freeze::default()).unwrap();
        let text = slurm(&manifest, &call());
        assert!(text.contains("#SBATCH --array=0-2\n"), "{text}");
        let quoted = r"tumble run 'my plan'\''s {1}.toml' --out out --coarse";
        assert!(text.contains(&format!("exec {quoted} --index")), "{text}");
        let text = gnu_parallel(&manifest, &call());
        assert!(text.starts_with("seq 0 2 | parallel 'tumble run"), "{text}");
        let text = snakemake(&manifest, &call());
        assert!(text.contains("range(3)") && text.contains("{{1}}"), "{text}");
    }

    #[test]
    fn a_shell_hands_the_words_on_as_they_are() {
        let words = ["plain", "with space", "it's", "$HOME `x` \\", ""];
        let echo = format!("printf '%s\\n' {}", words.map(quoted).join(" "));
        let Ok(shell) = std::process::Command::new("sh").args(["-c", &echo]).output() else {
            println!("skipped: no sh");
            return;
        };
        let text = String::from_utf8(shell.stdout).unwrap();
        assert_eq!(text.lines().collect::<Vec<_>>(), words);
    }
}
