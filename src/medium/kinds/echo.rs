//! A request that comes back to its master.

use super::*;

/// Gives the request back ahead of the reply, as on a 2-wire line whose receiver stays on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct EchoRequest {}

impl Fault for EchoRequest {
    const NAME: &'static str = "echo";
    const ABOUT: &'static str =
        "The request comes back before the reply, as on a 2-wire line whose receiver stays on.";
    const IMPOSSIBLE_ON_TCP: Option<&'static str> = Some("Modbus TCP has no echo");
    const TAKES_BROADCASTS: bool = true;

    fn read(_: &FaultKeys) -> Result<Self, KeyRefusal> {
        Ok(Self {})
    }

    fn on_request(&self, request: &MasterRequest<'_>, out: &mut Outgoing<'_>) {
        out.echo(&request.frame());
    }

    fn leaves(&self) -> Leaves {
        Leaves { before: 1, ..Leaves::INTACT }
    }

    fn describe(&self, unit: u8) -> String {
        format!("request to unit {unit} echoed")
    }
}
