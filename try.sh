cd /tmp/w/dw; S=/work/shared/garments/diffavatar-tshirt
for xs in 1 0.2 0.05 0.01; do for xt in 1 0.1; do
 XS=$xs XT=$xt nice -n 19 timeout 900 ./x1 transfer /tmp/m/fin-tshirt-draft.crease.json --to $S/tshirt.obj --unit cm -o q.glb > q.log 2>&1
 echo "XS $xs XT $xt: $(tail -1 q.log) $(grep -c converge q.log)"; python3 - q.crease.json <<'P'
import sys
src=open('/work/shared/tools/creases.py').read().split('p = argparse')[0]
exec(src)
g=Garment(sys.argv[1]); s=hinge_angles(g.x,g.h); shape=(hinge_angles(g.worn,g.h)-s+np.pi)%(2*np.pi)-np.pi
L=np.linalg.norm(g.x[g.h[:,1]]-g.x[g.h[:,0]],axis=1); q=abs(g.change)>np.radians(20)
d=np.linalg.norm(g.worn-g.x,axis=1)
e0=np.linalg.norm(g.x[g.t]-g.x[np.roll(g.t,1,1)],axis=2); e1=np.linalg.norm(g.worn[g.t]-g.worn[np.roll(g.t,1,1)],axis=2); st=e1/e0-1
print('   shown %.3f'%((L*shape*g.change)[q].sum()/(L*g.change**2)[q].sum()),'disp mean %.1f p95 %.1f max %.1f mm'%tuple(1e3*np.array([d.mean(),np.percentile(d,95),d.max()])),'stretch rms %.3f p99 %.3f max %.2f'%(st.std(),np.percentile(abs(st),99),abs(st).max()),'stray: |shape|>30 with memory<10: %.4f'%(L[(abs(shape)>.52)&(abs(g.change)<.17)].sum()/L.sum()))
P
done; done
