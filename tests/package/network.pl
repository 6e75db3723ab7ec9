# Listens on a UDP port for a while and prints how many datagrams it got from each address.
#   perl network.pl PORT SECONDS [GROUP [TEXT]]      GROUP: multicast, on lo; TEXT: only those that contain it
use strict;
use warnings;
use IO::Select;
use Socket;

my ($port, $seconds, $group, $wanted) = @ARGV;
socket(my $socket, PF_INET, SOCK_DGRAM, 0) or die "socket: $!";
setsockopt($socket, SOL_SOCKET, SO_REUSEADDR, 1);
setsockopt($socket, SOL_SOCKET, SO_REUSEPORT, 1);
bind($socket, sockaddr_in($port, INADDR_ANY)) or die "bind: $!";
if ($group) {
    # perl-base does not know IP_ADD_MEMBERSHIP: ip(7), linux/in.h.
    setsockopt($socket, 0, 35, pack('a4a4', inet_aton($group), INADDR_LOOPBACK)) or die "group: $!";
}
my %count;
my $end = time + $seconds;
while (time < $end) {
    next unless IO::Select->new($socket)->can_read(0.1);
    my $from = recv($socket, my $text, 65536, 0);
    $count{inet_ntoa((sockaddr_in($from))[1])}++ if defined $from and index($text, $wanted // '') >= 0;
}
print "$_ $count{$_}\n" for sort keys %count;
