//! What writing a value to a command row sets off.

use super::words;

words! {
    /// Something a drive does at once when told to.
    Action {
        Enable "enable" "switch the power stage on",
        Release "release" "switch the power stage off; it stays off until told otherwise",
        AlarmReset "alarm_reset" "clear an alarm whose cause is gone, if a reset can clear it",
        ClearPosition "clear_position" "call the present position 0",
        StoreAll "store_all" "keep all values in force over power-off",
        RestoreFactory "restore_factory" "put every value back as it left the factory",
        PowerCycle "power_cycle" "start anew, as if power had been off and on",
    }
}
