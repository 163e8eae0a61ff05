//! `optimize task import`: creates a task from meshes of plug and socket.

use crate::failure::within;
use crate::layout::wrapped;
use crate::setup::bodies::{PairRequest, parts};
use crate::setup::files::{check_is_new, robot};
use crate::setup::mated::{MatedTask, left_out_json, mated};
use crate::setup::tune::{brief, chosen, tune_new};
use crate::{
    Context, Failure, Output, RobotRequest, TaskCheck, TaskFile, command, not_stopped, read_task,
};
use connector::body::width;
use connector::mesh::axes::{Unit, value};
use connector::mesh::mated::{PairTask, check_handle};
use connector::seat::RotationalPlay;
use connector::tune::Tuned;
use connector::write::{self, Notes};
use input::shipped::Source;
use input::units::{DEG, MM};
use insertion::task::parts_file::{PartsFile, joined, sha256};
use serde_json::{Value, json};
use std::path::Path;
use study::write_file;

/// Largest number of parts that are written into the task file itself.
const MAX_INLINE: usize = 30;

/// Create a task from meshes of a plug and its socket (STL, OBJ or STEP)
///
/// Give one file with both in their mated pose, or one file each with --plug and --socket, in any pose: the mated
/// pose is found from their shapes. STEP needs the Python package with its extra `step`. The faces that can come into
/// contact become convex parts, within 0.02 mm of the drawing; many parts are written to a file beside the task. Faces
/// that overlap in the mated pose are listed: contact springs, drawn unloaded, are left out, and in a press fit one of
/// the two faces is cut back. Unit, direction and axis of the jaws are derived from the shapes and printed, unless they
/// are given. Grip and strategy are derived from the shapes, too; with --like the strategy is that of another task, on
/// these shapes.
#[derive(Debug, Clone, clap::Args)]
#[command(
    after_help = "Example: optimize task import --plug plug.stl --socket socket.stl --out mine.toml"
)]
pub struct Request {
    /// Plug, socket and their mate.
    #[command(flatten)]
    pub pair: PairRequest,
    /// Robot and contact engine.
    #[command(flatten)]
    pub robot: RobotRequest,
    /// Names of plug and socket in messages and in the task file [default: their paths]
    #[arg(long, hide = true, num_args = 2, allow_hyphen_values = true)]
    pub names: Vec<String>,
}

impl command::Request for Request {
    const PROGRESS: bool = true;

    fn run(&self, context: &Context<'_>) -> Result<Output, Failure> {
        let stop = context.stop;
        let out = &self.pair.out();
        within("--depth-mm", self.pair.depth_mm, &(0.4..=300.0))?;
        let handle = self.pair.body.map_or(Ok(()), check_handle);
        handle.map_err(|problem| Failure::usage(format!("--body: {problem}")))?;
        check_is_new(out)?;
        robot(&self.robot.name)?;
        let mut mated = self.mated_task(context)?;
        not_stopped(stop)?;
        let _busy = context.busy("trying strategies");
        let (task, mut tuned) = tune_new(mated.made.task, &self.robot, stop)?;
        mated.made.task = task;
        tuned.iter_mut().for_each(|tuned| tuned.steps[0].change.clone_from(&mated.strategy));
        let checked = TaskCheck::of(self.write(out, &mated)?.source, &self.robot, stop)?;
        let tuned = tuned.as_ref();
        let text = text(&self.names(), &mated, tuned, &checked);
        let failure = checked.failure_of_new(tuned);
        Ok(Output { failure, ..Output::new(text, json(&mated, tuned, &checked)) })
    }
}

impl Request {
    /// Returns the names of plug and socket in messages.
    fn names(&self) -> [String; 2] {
        let paths =
            || [self.pair.plug(), self.pair.socket()].map(|path| path.display().to_string());
        <[String; 2]>::try_from(self.names.clone()).unwrap_or_else(|_| paths())
    }

    /// Writes the task; more parts than [`MAX_INLINE`] go to a separate file beside it.
    fn write(&self, out: &Path, mated: &MatedTask) -> Result<TaskFile, Failure> {
        let (task, mut notes) = (&mated.made.task, self.notes(mated));
        let file = out.display().to_string();
        if task.plug.parts.len() + task.socket.len() <= MAX_INLINE {
            let written = TaskFile::parse(Source { file, text: write::task(task, &notes) })?;
            write_file(out, &written.source.text)?;
            return Ok(written);
        }
        let (beside, parts) = (out.with_extension("parts.toml"), write::parts_file(task));
        let name = beside.file_name().unwrap_or_default().to_string_lossy().into_owned();
        notes.parts = Some(PartsFile { file: name, sha256: sha256(&parts) });
        let text = write::task(task, &notes);
        let written = TaskFile::parse(Source { file, text: joined(&text, &parts) })?;
        write_file(&beside, &parts)?;
        // If the task cannot be written, its parts file is removed.
        write_file(out, &text).inspect_err(|_| drop(std::fs::remove_file(&beside)))?;
        Ok(written)
    }

    /// Returns the task made of the shapes in their mated pose.
    fn mated_task(&self, context: &Context<'_>) -> Result<MatedTask, Failure> {
        let like = self.pair.like.as_deref().map(read_task).transpose()?;
        let names = self.names();
        let files = names.each_ref().map(String::as_str);
        let parts = parts(files, &self.pair, context)?;
        not_stopped(context.stop)?;
        let mut task =
            mated(files, parts, &self.pair, like.as_ref().map(|like| &like.task), context)?;
        let warnings = task.findings.iter().filter(|(what, _)| *what == "warning");
        let about = [description(&names)].into_iter().chain(warnings.map(|(_, why)| why.clone()));
        task.made.task.description = about.collect::<Vec<_>>().join("; ");
        Ok(task)
    }

    fn notes(&self, MatedTask { made, unit, along, jaws, .. }: &MatedTask) -> Notes {
        let [plug, socket] = self.names();
        let [unit, along, jaws] = [value(*unit), value(*along), value(*jaws)];
        let head = format!(
            "Imported from {plug} and {socket}, unit `{unit}`, inserted along {along}, jaws along {jaws}."
        );
        let held = made.task.plug.parts.last().map_or("", |part| &part.name);
        let held = format!(
            "The plug's part `{held}` is a block for the pads, not a shape of the drawing."
        );
        let head = vec![head.replace(['\n', '\r'], " "), held];
        let left_out = made.interference.iter().any(|of| !of.cut_back);
        Notes { head, top: made.top, parts: None, left_out }
    }
}

/// Returns a one-line description of a task from these files.
fn description(files: &[String; 2]) -> String {
    let name = |file: &String| {
        let name = Path::new(file).file_name();
        name.map_or(file.clone(), |name| name.to_string_lossy().into_owned())
    };
    match files[0] == files[1] {
        true => format!("from {}", name(&files[0])),
        false => format!("from {} and {}", name(&files[0]), name(&files[1])),
    }
}

/// Returns an imported task as JSON: its parts, the strategies that were tried, and the check of its file.
fn json(mated: &MatedTask, tuned: Option<&Tuned>, checked: &TaskCheck) -> Value {
    let task = &mated.made.task;
    let [plug_parts, socket_parts] = [task.plug.parts.len(), task.socket.len()];
    let [clearance_x_mm, clearance_y_mm] = mated.made.play.map(|play| play / MM);
    let found = mated.findings.iter().map(|(what, why)| format!("{what} {why}"));
    let left_out = mated.made.interference.iter().map(left_out_json);
    json!({
        "parts": plug_parts + socket_parts,
        "plug_parts": plug_parts,
        "socket_parts": socket_parts,
        "unit": value(mated.unit),
        "insert_along": value(mated.along),
        "jaws": value(mated.jaws),
        "poses": mated.poses,
        "found": found.collect::<Vec<_>>(),
        "clearance_mm": clearance_x_mm.min(clearance_y_mm),
        "clearance_x_mm": clearance_x_mm,
        "clearance_y_mm": clearance_y_mm,
        "clearance_about_z_deg": mated.turn.map(|play| play.angle / DEG),
        "clearance_about_z_mm": mated.turn.map(|play| play.arc / MM),
        "body_mm": body_mm(&mated.made),
        "plug_was_inward": mated.inward[0],
        "socket_was_inward": mated.inward[1],
        "left_out": left_out.collect::<Vec<_>>(),
        "out": checked.source.file,
        "tuned": chosen(tuned),
        "check": checked.json(),
    })
}

/// Returns the body that the fingers hold: width between the jaws, height in x, length above z = 0 when seated.
fn body_mm(made: &PairTask) -> [f64; 3] {
    let grip = &made.task.grip;
    [width(grip.faces_y), made.held, grip.shoulder_z + made.mated_z()].map(|side| side / MM)
}

fn text(
    [plug, socket]: &[String; 2],
    mated: &MatedTask,
    tuned: Option<&Tuned>,
    checked: &TaskCheck,
) -> String {
    let (task, out) = (&mated.made.task, &checked.source.file);
    let [plug_parts, socket_parts] = [task.plug.parts.len(), task.socket.len()];
    let [clearance_x_mm, clearance_y_mm] = mated.made.play.map(|play| play / MM);
    let [wide, high, long] = body_mm(&mated.made);
    let [along, jaws] = [value(mated.along), value(mated.jaws)];
    let along =
        along.strip_prefix('-').map_or(format!("along {along}"), |axis| format!("against {axis}"));
    let turn = mated.turn.map_or(String::new(), |RotationalPlay { angle, arc }| {
        format!(", {:.1}° about its z ({:.3} mm at the farthest corner)", angle / DEG, arc / MM)
    });
    let lines = |of: Vec<&(&str, String)>| -> String {
        of.iter().map(|(what, why)| format!("{what:<14}{why}\n")).collect()
    };
    let guessed = |(what, _): &&(&str, String)| *what == "unit" && mated.unit != Unit::Mm;
    let (guesses, findings) = mated.findings.iter().partition(guessed);
    let mut text = lines(guesses);
    text += &format!(
        "written       {out}\nplug          {plug}, {plug_parts} convex parts: held by the fingers\n\
         socket        {socket}, {socket_parts} convex parts: fixed\n\
         axes          of the socket's file: inserted {along}, the jaws close along {jaws}; in the task these are -z and y\n\
         clearance     between plug.part and socket.part, both sides together: {clearance_y_mm:.3} mm in the task's y, {clearance_x_mm:.3} mm in its x{turn}\n\
         body          {wide:.1} x {high:.1} mm between the pads (the task's y, x), up to its z = {long:.1} mm when seated\n"
    );
    text += &lines(findings);
    text.extend(tuned.map(|tuned| brief("strategy", tuned)));
    text += &checked.text_of_new();
    wrapped(&text)
}
