#!/bin/sh
# A Slurm cluster of one node in a folder of its own: sh tools/farm/cluster.sh start FOLDER, sh tools/farm/cluster.sh stop FOLDER.
# For trying array jobs where there is no cluster. It has its own key, ports and state, and touches no Slurm that is installed for use.
# Commands find it by SLURM_CONF=FOLDER/slurm.conf. Needs root and Debian's slurmctld, slurmd, slurm-client and munge.
set -eu
usage() { echo "usage: sh tools/farm/cluster.sh start|stop FOLDER" >&2; exit 64; }
[ $# -eq 2 ] || usage

stop() { # by the numbers in their own files, the last started first
    for name in slurmctld slurmd munged; do
        [ -s "$folder/$name.pid" ] || continue
        pid=$(cat "$folder/$name.pid")
        kill "$pid" 2>/dev/null || continue
        for _ in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20; do
            kill -0 "$pid" 2>/dev/null || break
            sleep 0.25
        done
        kill -9 "$pid" 2>/dev/null || true
    done
}

# Two free ports, near each other.
ports() {
    python3 - <<'EOF'
import socket
found = []
for _ in range(2):
    s = socket.socket()
    s.bind(("127.0.0.1", 0))
    found.append(s)
print(*(s.getsockname()[1] for s in found))
EOF
}

start() {
    for program in munged slurmctld slurmd sbatch; do
        command -v "$program" >/dev/null || { echo "error: no $program; apt-get install slurmctld slurmd slurm-client munge" >&2; exit 4; }
    done
    [ "$(id -u)" = 0 ] || { echo "error: starting slurmd needs root" >&2; exit 4; }
    mkdir -p "$folder/state" "$folder/spool"
    chmod 755 "$folder"
    host=$(hostname -s)
    cpus=$(nproc)
    ports | { read -r ctl node; printf '%s %s\n' "$ctl" "$node" >"$folder/ports"; }
    read -r ctl node <"$folder/ports"
    head -c 1024 /dev/urandom >"$folder/munge.key"
    chmod 400 "$folder/munge.key"
    munged --force --socket="$folder/munge.socket" --key-file="$folder/munge.key" --pid-file="$folder/munged.pid" \
        --log-file="$folder/munged.log" --seed-file="$folder/munge.seed"
    cat >"$folder/slurm.conf" <<EOF
ClusterName=chiaro
SlurmctldHost=$host(127.0.0.1)
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket=$folder/munge.socket
SlurmctldPort=$ctl
SlurmdPort=$node
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
SlurmctldLogFile=$folder/slurmctld.log
SlurmdLogFile=$folder/slurmd.log
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=batch_sched_delay=0,sched_interval=2
AccountingStorageType=accounting_storage/none
JobAcctGatherType=jobacct_gather/none
JobRequeue=1
ReturnToService=2
KillWait=5
NodeName=$host NodeAddr=127.0.0.1 CPUs=$cpus State=UNKNOWN
PartitionName=farm Nodes=ALL Default=YES MaxTime=INFINITE State=UP
EOF
    SLURM_CONF="$folder/slurm.conf"
    export SLURM_CONF
    slurmctld -f "$SLURM_CONF"
    slurmd -f "$SLURM_CONF"
    tries=0
    until [ "$(sinfo -h -o %t 2>/dev/null)" = idle ]; do
        tries=$((tries + 1))
        [ $tries -lt 120 ] || { echo "error: the cluster does not come up; see $folder/slurmctld.log and slurmd.log" >&2; exit 4; }
        sleep 0.5
    done
}

case $1 in
start) mkdir -p "$2"; folder=$(cd "$2" && pwd); start ;;
stop) [ -d "$2" ] || exit 0; folder=$(cd "$2" && pwd); stop ;;
*) usage ;;
esac
